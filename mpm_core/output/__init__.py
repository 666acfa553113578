"""What a run leaves in its folder: frames, history, summary, checkpoint, pictures."""
