"""Robot files of bars and plane frames whose forces are known by hand, and their weight."""

import numpy as np

E, RHO, L, B, H = 2.0e11, 7800.0, 2.0, 0.05, 0.1
Q = RHO * B * H * 9.81
STEEL = f"{{ E = {E}, nu = 0.0, rho = {RHO} }}"
BAR = f'section = {{ shape = "rectangle", width = {B}, height = {H} }}, material = {STEEL}'
CANTILEVER = f"""
schema = 2
name = "cantilever"
points = {{ A = [0.0, 0.0, 0.0], P = [{L}, 0.0, 0.0] }}
bodies.bar = {{ from = "A", to = "P", {BAR} }}
joints.clamp = {{ type = "fixed", between = ["ground", "bar"], at = "A" }}
tool = {{ body = "bar", point = "P", moves = [] }}
"""
# A beam of two equal halves; RIGHT is its right support.
BEAM = f"""
schema = 2
name = "beam"
points = {{ A = [0.0, 0.0, 0.0], M = [{L / 2}, 0.0, 0.0], B = [{L}, 0.0, 0.0] }}
bodies.left = {{ from = "A", to = "M", {BAR} }}
bodies.right = {{ from = "M", to = "B", {BAR} }}
joints.weld = {{ type = "fixed", between = ["left", "right"], at = "M" }}
joints.a = {{ type = "LEFT", between = ["ground", "left"], at = "A" }}
joints.b = {{ type = "RIGHT", between = ["ground", "right"], at = "B" }}
tool = {{ body = "left", point = "M", moves = [] }}
"""
# Two pinned bars, from (0, 0) and (4, 0) to their common pin at (4, 3): lengths 5 and 3.
TRIANGLE = f"""
schema = 2
name = "triangle"
points = {{ A = [0.0, 0.0, 0.0], B = [4.0, 0.0, 0.0], P = [4.0, 3.0, 0.0] }}
bodies.long = {{ from = "A", to = "P", {BAR} }}
bodies.short = {{ from = "B", to = "P", {BAR} }}
joints.a = {{ type = "revolute", between = ["ground", "long"], at = "A", axis = [0, 0, 1] }}
joints.b = {{ type = "revolute", between = ["ground", "short"], at = "B", axis = [0, 0, 1] }}
joints.p = {{ type = "revolute", between = ["long", "short"], at = "P", axis = [0, 0, 1] }}
tool = {{ body = "long", point = "P", moves = [] }}
"""
WEIGHT = {"gravity": np.array([0.0, 0.0, -9.81])}
