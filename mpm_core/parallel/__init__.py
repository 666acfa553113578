"""How points are sorted and passes over them are shared between threads, with the same sums for any number."""
