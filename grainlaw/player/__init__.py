"""The page that plays a run: its frames in a file that a browser shows by itself."""
