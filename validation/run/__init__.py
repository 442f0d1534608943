"""Where work is computed, and what outlives a process: one executor, one cache, one run folder."""
