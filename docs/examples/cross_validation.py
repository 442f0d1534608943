"""Every formulation of the same legs against solids: sentence, assertions, picture."""

import flexproof as fp

crossed = fp.cross_validate("ifw", preset="quick")
print(crossed.sentence)
crossed.assert_agrees("beam", with_="solid", quantity="f1", within=0.01, body="leg1")
crossed.assert_agrees("vjm", "links", quantity="phi_x", within=1e-9, body="leg1")
crossed.assert_converged("f1", elements=20, within=0.01)
crossed.plot().savefig("cross-validation.png")
