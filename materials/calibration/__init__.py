"""Calibration: the parameters of a law from element-test data, with what the data say about each of them."""
