"""Many runs of one scene for one answer: batches of runs on many processes, sweeps, what they say."""
