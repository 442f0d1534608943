"""
02 Convergence with element count
=================================

How many rigid segments, or beam elements, does leg 1 of the built-in robot need? The paper's robot
has 20 segments per leg, and claims an error below 1 %.
"""

import flexproof as fp

study = fp.converge("ifw", body="leg1")
study.plot()

# %%
# Segments with half-length end springs converge with order 2, beam elements with order 4, and the
# literal layout of the paper, springs between elements only, with order 1: 5 % at 20 segments.

series = study.of("segments")
literal = study.of("segments", "literal")
for name, one in (("half-length end springs", series), ("springs between elements only", literal)):
    error = one.errors[one.counts.index(20), study.column("f2")]
    print(f"{name}: f2 {100.0 * error:+.4f} % with 20 segments")

# %%
# In a test of your own:

study.assert_converged("f2", elements=20, within=0.01)
print(study.text("f2"))
