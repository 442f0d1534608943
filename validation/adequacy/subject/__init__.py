"""What all robots share in their assessment, whatever computes their answers.

In: a robot in its postures, with what computes its models and references. Out: `response.Subject`,
which knows nothing of legs and poses.
"""
