"""The return maps of Modified Cam Clay and of its rate-dependent extension, which two laws share."""
