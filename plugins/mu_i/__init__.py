"""What the laws of the mu(I) family share."""
