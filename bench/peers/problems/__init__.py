"""Every problem of the comparison, transcribed for the peers."""
