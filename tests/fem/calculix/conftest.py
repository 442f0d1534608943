import pytest

from meshes.gmsh_session import gmsh_model


@pytest.fixture(scope="session")
def bar_step(tmp_path_factory):
    """A bar of 170 × 40 × 30 mm with bores of radius 8 and 6 along z, the first at the origin."""
    path = tmp_path_factory.mktemp("bar") / "bar.step"
    with gmsh_model("bar") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        occ = gmsh.model.occ
        bar = occ.addBox(-20, -20, -15, 170, 40, 30)
        bores = [(3, occ.addCylinder(x, 0, -30, 0, 0, 60, r)) for x, r in ((0, 8), (130, 6))]
        occ.cut([(3, bar)], bores)
        occ.synchronize()
        gmsh.write(str(path))
    return path
