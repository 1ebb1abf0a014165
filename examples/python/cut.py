"""A jelly cube is held at its top, cut by a wave and a plane, and falls apart. Prints what there is to know of its pieces; draws
the last frame where matplotlib is installed.

usage: python3 cut.py [FRAMES]      after `make lib`
"""
import sys

import numpy as np

import gxfem


def grid(n):
    """a unit cube of n^3 cubes, six tetrahedra each"""
    line = np.arange(n + 1)
    z, y, x = np.meshgrid(line, line, line, indexing='ij')
    positions = np.stack([x, y, z], axis=-1).reshape(-1, 3) / n
    corner = (np.arange(n)[:, None, None] * (n + 1) + np.arange(n)[None, :, None]) * (n + 1) + np.arange(n)
    steps = [(1, 2, 4), (2, 4, 1), (4, 1, 2), (2, 1, 4), (1, 4, 2), (4, 2, 1)]  # the ways from a corner to the opposite one
    offset = np.array([1, n + 1, (n + 1) ** 2])
    tetrahedra = []
    for i, way in enumerate(steps):
        places = np.cumsum([0] + [offset[step.bit_length() - 1] for step in way])
        tetrahedra.append(corner.reshape(-1, 1) + (places if i < 3 else places[[0, 2, 1, 3]]))
    return positions, np.concatenate(tetrahedra)


def sheet(height, n=24):
    """a surface z = height(x, y) beyond the cube, as vertices and triangles"""
    side = np.linspace(-0.1, 1.1, n + 1)
    x, y = np.meshgrid(side, side)
    vertices = np.stack([x, y, height(x, y)], axis=-1).reshape(-1, 3)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).reshape(-1, 1)
    return vertices, np.concatenate([a + [0, 1, n + 2], a + [0, n + 2, n + 1]])


def main(frames):
    body = gxfem.Body(*grid(8), young=2e4, poisson=0.4, density=1000)
    body.hold(gxfem.half_space(2, 1, 0.99))
    for frame in range(frames):
        if frame == 10:
            report = body.cut(sheet(lambda x, y: 0.6 + 0.05 * np.sin(12 * x)), sheet(lambda x, y: 0.3 + 0 * x))
            print(f'cut: {report["touched_elements"]} elements, {report["created_copies"]} more copies of nodes')
        body.step(1 / 60, gravity=(0, 0, -9.81), integrator=gxfem.native.GXS_BDF2)
    view = body.view()
    for i, motion in enumerate(body.motions()):
        print(f'piece {view.fragment_id[i]}: {motion.mass:.1f} kg, centre at z = {motion.center[2]:.3f} m')
    skin, positions = body.skin(), body.positions()
    print(f'skin: {skin.triangle_count} triangles of {positions.shape[0]} vertices')
    try:
        from matplotlib import pyplot
    except ImportError:
        return
    axes = pyplot.figure().add_subplot(projection='3d')
    for i in range(view.fragment_count):
        axes.plot_trisurf(*positions.T, triangles=skin.triangles[skin.triangle_fragment == i])
    pyplot.show()


if __name__ == '__main__':
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 40)
