"""The table of what the paper says, each statement with the function that computes it."""
