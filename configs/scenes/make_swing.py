#!/usr/bin/env python3
"""Writes swing.glb, the animated scene of configs/animation.toml. Needs nothing but Python 3.

    python3 configs/scenes/make_swing.py [FILE]

A ring of pillars stands on a floor of tiles and does not move. Within it a gear turns, a pendulum
swings (cubic spline), a ball bulges (morph target) and a mast bends (two joints). Lengths are in the
scene's own unit, y is up; the animation 'swing' lasts one second and ends as it began.
"""
import json
import math
import pathlib
import struct
import sys


class File:
    """A glTF model in the making, all its data in one buffer."""

    def __init__(self):
        self.data = bytearray()
        self.model = {
            "asset": {"version": "2.0", "generator": "make_swing.py"},
            "scene": 0,
            "scenes": [{"name": "swing", "nodes": []}],
            "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": []}},
        }

    def accessor(self, values, code, component, kind, width, bounds=False):
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(values) * struct.calcsize(code)}
        self.data += struct.pack("<%d%s" % (len(values), code), *values)
        self.model["bufferViews"].append(view)
        entry = {"bufferView": len(self.model["bufferViews"]) - 1, "componentType": component, "type": kind,
                 "count": len(values) // width}
        if bounds:
            floats = struct.unpack("<%df" % len(values), struct.pack("<%df" % len(values), *values))
            entry["min"] = [min(floats[i::width]) for i in range(width)]
            entry["max"] = [max(floats[i::width]) for i in range(width)]
        self.model["accessors"].append(entry)
        return len(self.model["accessors"]) - 1

    def vectors(self, points, bounds=False):
        return self.accessor([c for p in points for c in p], "f", 5126, "VEC3", 3, bounds)

    def scalars(self, values):
        return self.accessor(values, "f", 5126, "SCALAR", 1, True)

    def add(self, group, entry):
        self.model[group].append(entry)
        return len(self.model[group]) - 1

    def material(self, name, color, reflection=0.0):
        own = {"color": color, "specular_color": [1, 1, 1], "emission": [0, 0, 0], "diffuse": 1.0 - reflection,
               "reflection": reflection, "transmission": 0.0, "ior": 1.0, "highlight": 0.3, "shininess": 40.0}
        return self.add("materials", {
            "name": name,
            "pbrMetallicRoughness": {"baseColorFactor": color + [1.0], "metallicFactor": reflection,
                                     "roughnessFactor": 1.0 - reflection},
            "extras": {"marti": own}})

    def mesh(self, name, parts, material, **attributes):
        """`parts` are points and triangles; more attributes and `targets` are accessors."""
        points, triangles = parts
        targets = attributes.pop("targets", None)
        primitive = {
            "attributes": {"POSITION": self.vectors(points, True), **attributes},
            "indices": self.accessor([i for t in triangles for i in t], "H", 5123, "SCALAR", 1),
            "material": material}
        entry = {"name": name, "primitives": [primitive]}
        if targets:
            primitive["targets"] = [{"POSITION": t} for t in targets]
            entry["weights"] = [0.0] * len(targets)
        return self.add("meshes", entry)

    def node(self, root=True, **properties):
        index = self.add("nodes", properties)
        if root:
            self.model["scenes"][0]["nodes"].append(index)
        return index

    def write(self, path):
        self.model["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.model, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + bytes(-len(self.data) % 4)
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) +
                         struct.pack("<I4s", len(text), b"JSON") + text +
                         struct.pack("<I4s", len(data), b"BIN\0") + data)


def box(width, height, depth):
    """A box that stands on y = 0."""
    points = [(x * width / 2, y * height, z * depth / 2) for x in (-1, 1) for y in (0, 1) for z in (-1, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]


def prism(outline, heights):
    """An outline around the y axis, counter-clockwise seen from above, through rising heights."""
    n = len(outline)
    points = [(x, y, z) for y in heights for x, z in outline]
    triangles = []
    for level in range(len(heights) - 1):
        for i in range(n):
            a, b = level * n + i, level * n + (i + 1) % n
            triangles += [(a, a + n, b), (b, a + n, b + n)]
    for level in (0, len(heights) - 1):
        center = len(points)
        points.append((0.0, heights[level], 0.0))
        for i in range(n):
            a, b = level * n + i, level * n + (i + 1) % n
            triangles.append((center, a, b) if level == 0 else (center, b, a))
    return points, triangles


def circle(radius, corners):
    return [(radius * math.cos(2 * math.pi * i / corners), radius * math.sin(2 * math.pi * i / corners))
            for i in range(corners)]


def gear(teeth, inner, outer):
    return [((outer if i % 4 in (1, 2) else inner) * math.cos(2 * math.pi * i / (4 * teeth)),
             (outer if i % 4 in (1, 2) else inner) * math.sin(2 * math.pi * i / (4 * teeth)))
            for i in range(4 * teeth)]


def ball(radius, rings, corners):
    points = [(0.0, -radius, 0.0)]
    for ring in range(1, rings):
        angle = math.pi * ring / rings
        points += [(x, -radius * math.cos(angle), z) for x, z in circle(radius * math.sin(angle), corners)]
    points.append((0.0, radius, 0.0))
    triangles = []
    for i in range(corners):
        k = (i + 1) % corners
        triangles.append((0, 1 + i, 1 + k))
        for ring in range(rings - 2):
            a, b = 1 + ring * corners + i, 1 + ring * corners + k
            triangles += [(a, a + corners, b), (b, a + corners, b + corners)]
        last = 1 + (rings - 2) * corners
        triangles.append((len(points) - 1, last + k, last + i))
    return points, triangles


def turn(axis, degrees):
    half = math.radians(degrees) / 2
    return [c * math.sin(half) for c in axis] + [math.cos(half)]


def main():
    file = File()
    stone = file.material("stone", [0.75, 0.72, 0.65])
    slate = file.material("slate", [0.25, 0.3, 0.35])
    brass = file.material("brass", [0.85, 0.65, 0.25], 0.3)
    red = file.material("red", [0.8, 0.15, 0.1])
    blue = file.material("blue", [0.15, 0.3, 0.8])

    # What stands still: tiles and pillars.
    light_tile = file.mesh("light tile", box(1.0, 0.2, 1.0), stone)
    dark_tile = file.mesh("dark tile", box(1.0, 0.2, 1.0), slate)
    for x in range(-5, 5):
        for z in range(-5, 5):
            file.node(mesh=dark_tile if (x + z) % 2 else light_tile, translation=[x + 0.5, -0.2, z + 0.5])
    pillar = file.mesh("pillar", prism(circle(0.18, 16), [0.0, 0.3, 1.2, 1.5]), stone)
    for i in range(12):
        angle = 2 * math.pi * i / 12
        file.node(mesh=pillar, translation=[4.2 * math.cos(angle), 0.0, 4.2 * math.sin(angle)])

    # A gear that turns by one tooth.
    wheel = file.node(mesh=file.mesh("gear", prism(gear(16, 0.85, 1.05), [0.0, 0.25]), brass),
                      translation=[-1.6, 0.0, 1.2], name="gear")

    # A pendulum under a beam.
    file.node(mesh=file.mesh("beam", box(0.2, 2.4, 0.2), slate), translation=[1.6, 0.0, 0.2])
    rod_points, rod_triangles = box(0.08, 1.4, 0.08)
    rod = file.mesh("rod", ([(x, -y, z) for x, y, z in rod_points],
                            [(a, c, b) for a, b, c in rod_triangles]), slate)
    bob = file.node(root=False, mesh=file.mesh("bob", ball(0.3, 10, 16), red), translation=[0.0, -1.5, 0.0])
    pendulum = file.node(mesh=rod, translation=[1.6, 2.3, 0.4], children=[bob], name="pendulum")

    # A ball that bulges.
    points, triangles = ball(0.5, 16, 24)
    bulge = file.vectors([(0.5 * x, -0.3 * y, 0.5 * z) for x, y, z in points])
    bulging = file.node(mesh=file.mesh("ball", (points, triangles), blue, targets=[bulge]),
                        translation=[0.0, 0.5, -1.4], name="ball")

    # A mast whose upper half bends.
    points, triangles = prism(circle(0.14, 12), [0.25 * i for i in range(9)])
    upper = [min(1.0, max(0.0, y - 0.5)) for _, y, _ in points]
    joints = file.accessor([j for _ in points for j in (0, 1, 0, 0)], "B", 5121, "VEC4", 4)
    weights = file.accessor([c for u in upper for c in (1.0 - u, u, 0.0, 0.0)], "f", 5126, "VEC4", 4)
    mast = file.mesh("mast", (points, triangles), red, JOINTS_0=joints, WEIGHTS_0=weights)
    bend = file.node(root=False, translation=[0.0, 1.0, 0.0], name="bend")
    foot = file.node(translation=[-1.8, 0.0, -1.6], children=[bend], name="foot")
    lower = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    higher = lower[:13] + [-1] + lower[14:]
    file.model["skins"] = [{"joints": [foot, bend], "inverseBindMatrices":
                            file.accessor(lower + higher, "f", 5126, "MAT4", 16)}]
    file.node(mesh=mast, skin=0)

    # Light and view.
    lights = file.model["extensions"]["KHR_lights_punctual"]["lights"]
    lights.append({"type": "point", "intensity": 0.9, "extras": {"marti": {"inverse_square": False}}})
    file.node(translation=[3.0, 7.0, 5.0], extensions={"KHR_lights_punctual": {"light": 0}})
    file.model["extras"] = {"marti": {"background": [0.3, 0.45, 0.6], "ambient": [0.2, 0.2, 0.2]}}
    file.model["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.72, "znear": 0.1}}]
    file.node(camera=0, translation=[0.0, 5.2, 8.6], rotation=turn((1, 0, 0), -31))

    # The animation.
    channels, samplers = [], []

    def animate(node, path, times, output, interpolation="LINEAR"):
        samplers.append({"input": file.scalars(times), "output": output, "interpolation": interpolation})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})

    def rotations(list_of_rotations):
        return file.accessor([c for r in list_of_rotations for c in r], "f", 5126, "VEC4", 4)

    animate(wheel, "rotation", [0.0, 1.0], rotations([turn((0, 1, 0), 0.0), turn((0, 1, 0), 22.5)]))
    swing = []
    for degrees, speed in ((0, 260), (35, 0), (0, -260), (-35, 0), (0, 260)):
        half = math.radians(degrees) / 2
        slope = math.radians(speed) / 2
        tangent = [0.0, 0.0, slope * math.cos(half), -slope * math.sin(half)]
        swing += [tangent, turn((0, 0, 1), degrees), tangent]
    animate(pendulum, "rotation", [0.0, 0.25, 0.5, 0.75, 1.0], rotations(swing), "CUBICSPLINE")
    animate(bulging, "weights", [0.0, 0.5, 1.0], file.accessor([0.0, 1.0, 0.0], "f", 5126, "SCALAR", 1))
    animate(bend, "rotation", [0.0, 0.25, 0.75, 1.0],
            rotations([turn((0, 0, 1), d) for d in (0, 40, -40, 0)]))
    file.model["animations"] = [{"name": "swing", "channels": channels, "samplers": samplers}]

    file.write(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).with_name("swing.glb"))


main()
