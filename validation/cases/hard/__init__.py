"""What a user may do to it: ranges of parameters, impacts, thin bodies, edges of the domain, the limit of the step."""
