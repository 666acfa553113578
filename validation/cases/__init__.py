"""The validation cases, a room for each kind of problem.

A module holds one `CASE`, or `CASES` by name that are rows of one table.
"""
