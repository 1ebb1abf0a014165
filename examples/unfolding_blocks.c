/* unfolding_blocks: two blocks hang each on a small strip and are cut so that they unfold; the strips must not notice
   (RXFEM, Fig. 12).

   Cubes of 10 cm of 5 tetrahedra. A block is 10 x 4 x 10 of them, its strip 2 x 2 x 6, held by its top. Slits go
   through the blocks, in turn in the middle and on both sides, so that the blocks open like a lattice and stay below
   their strips: 1.4 cubes apart on the left, 1 on the right. No mass comes or goes, so the strips carry what they
   carried before. St. Venant-Kirchhoff as in RXFEM, which says nothing of sizes; steps of 5 ms. */
#include "scene.h"

enum { BLOCKS = 2, MOST_SLITS = 24, WIDE = 10, DEEP = 4, HIGH = 10, STRIP = 6, GAP = 4 };

static const double edge = 0.1; /* of a cube, m */

typedef struct slits {
    scene_sheet sheet[MOST_SLITS];
    int count;
} slits;

/* x of the middle of a block, cubes */
static double middle(int block) { return 0.5 * WIDE + block * (WIDE + GAP); }

/* Is a place, in cubes, in a block or a strip? */
static int is_body(const void *user, const double at[3]) {
    int block;
    (void)user;
    for (block = 0; block < BLOCKS; block++) {
        const double x = fabs(at[0] - middle(block)), y = fabs(at[1] - 0.5 * DEEP);
        if (at[2] < HIGH ? x < 0.5 * WIDE : x < 1.0 && y < 1.0) return 1;
    }
    return 0;
}

/* A slit from x0 to x1 at height z, cubes, that comes in along y */
static void add_slit(scene *s, slits *all, double x0, double x1, double z) {
    const double corner[3] = {x0 * edge, -0.5 * edge, z * edge}, u[3] = {0, (DEEP + 1) * edge, 0},
                 v[3] = {(x1 - x0) * edge, 0, 0};
    if (all->count < MOST_SLITS) all->sheet[all->count++] = scene_flat_sheet(s, corner, u, v, DEEP + 1);
}

/* From the top down: a slit in the middle, then one from either side, and so on. */
static void make_slits(scene *s, slits *all, int block, double apart) {
    const double x = middle(block);
    double z = HIGH - 2.13;
    int i;
    all->count = 0;
    for (i = 0; z > 0.5; i++, z -= apart) {
        if (i % 2 == 0)
            add_slit(s, all, x - 4.3, x + 4.3, z);
        else {
            add_slit(s, all, x - 0.55 * WIDE, x - 0.7, z);
            add_slit(s, all, x + 0.7, x + 0.55 * WIDE, z);
        }
    }
}

/* Mean downward displacement of a block's nodes at a height, cubes; m */
static double sunk(const scene *s, int block, double height) {
    double sum = 0.0;
    size_t copy, count = 0;
    for (copy = 0; copy < s->view.copy_count; copy++) {
        const double *at = s->mesh.positions + 3 * (size_t)s->view.copy_node[copy];
        if (fabs(at[2] / edge - height) > 0.01 || fabs(at[0] / edge - middle(block)) > 0.51 * WIDE) continue;
        sum -= s->view.displacement[3 * copy + 2];
        count++;
    }
    return sum / (double)count;
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "unfolding_blocks",
                             .about = "Two blocks hang each on a small strip and are cut so that they unfold; the "
                                      "strips stay as long as they are.",
                             .mesh = "grid:24,4,16",
                             .frames = 300,
                             .small_frames = 16};
    const double apart[BLOCKS] = {1.37, 0.97};
    gx_material material = {{GXS_ST_VENANT_KIRCHHOFF, 1e6, 0.4, 0, NULL, NULL}, 1000.0};
    double strip[BLOCKS], foot[BLOCKS], mass;
    slits cuts[BLOCKS];
    int block, i;
    scene s;
    scene_open(&s, &desc, argc, argv);
    scene_keep(&s, is_body, NULL);
    scene_scale(&s, edge, edge, edge);
    s.body_desc.materials = &material;
    s.body_desc.material_count = 1;
    s.step.dt = 0.005;
    scene_make(&s);
    scene_hold(&s, 2, 1, (HIGH + STRIP) * edge - 1e-9);
    mass = scene_mass(&s);
    scene_settle(&s, 1e-10);
    for (block = 0; block < BLOCKS; block++) {
        strip[block] = sunk(&s, block, HIGH + 1);
        foot[block] = sunk(&s, block, 0);
        make_slits(&s, &cuts[block], block, apart[block]);
    }
    for (; s.frame < s.frames; scene_step(&s))
        for (block = 0; block < BLOCKS; block++)
            for (i = 0; i < cuts[block].count; i++)
                scene_advance(&s, &cuts[block].sheet[i], 0.05 + 0.6 * i / cuts[block].count,
                              0.05 + 0.6 * (i + 1) / cuts[block].count);
    mass = fabs(scene_mass(&s) / mass - 1.0);
    scene_check(&s, mass <= 1e-12, "mass against the uncut blocks': %.1e (at most 1e-12)", mass);
    scene_say(&s, "residual of the rest: %.1e", scene_settle(&s, 1e-10));
    for (block = 0; block < BLOCKS; block++) {
        const double longer = sunk(&s, block, HIGH + 1), down = sunk(&s, block, 0);
        scene_check(&s, fabs(longer / strip[block] - 1.0) <= 0.01,
                    "strip %d at rest: longer by %.5f m (%.5f m before the cuts, within 1 %%)", block + 1, longer,
                    strip[block]);
        scene_check(&s, down > 3.0 * foot[block],
                    "foot of block %d at rest: down by %.4f m (more than three times the %.4f m before the cuts)",
                    block + 1, down, foot[block]);
    }
    scene_check(&s, s.view.fragment_count == BLOCKS, "fragments: %lu (2)", (unsigned long)s.view.fragment_count);
    scene_check_body(&s);
    for (block = 0; block < BLOCKS; block++)
        for (i = 0; i < cuts[block].count; i++) scene_drop_sheet(&cuts[block].sheet[i]);
    return scene_close(&s);
}
