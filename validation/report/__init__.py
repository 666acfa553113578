"""What a validation run leaves behind: JSON, JUnit and one self-contained page."""
