"""The paper's column beside the piles of other MPM codes."""
