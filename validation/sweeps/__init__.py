"""Units of work for the cores of this machine or a cluster, and a journal of what is finished."""
