/* sausage: a sausage that hangs from its upper end is fed downwards; a knife slices it, and the slices fall one on the
   other.

   The knife goes through at one height, along x, in steps of the simulation: what is below its edge hangs by ever less,
   and the slice's faces slide on each other before it falls. The pile is what the knife made: the first slice lies
   lowest. */
#include "scene.h"

#include "touching.h"

enum { SLICES = 4 };

static const double radius = 0.03, thickness = 0.02, knife = 0.0, drop = 0.1, length = 0.16; /* m; height; m; m; m */

/* A square grid of cubes becomes round: rings of squares become circles. */
static void shape_sausage(scene *s, uint32_t across, uint32_t along) {
    size_t i;
    for (i = 0; i < s->mesh.node_count; i++) {
        double *at = s->mesh.positions + 3 * i;
        const double x = 2.0 * at[0] / across - 1.0, y = 2.0 * at[1] / across - 1.0;
        at[0] = radius * x * sqrt(1.0 - 0.5 * y * y);
        at[1] = radius * y * sqrt(1.0 - 0.5 * x * x);
        at[2] = knife + length * at[2] / along;
    }
}

/* The edge is along y, and goes along x. */
static void knife_point(const void *user, double a, double b, double *at) {
    (void)user;
    at[0] = 2.0 * radius * (2.0 * a - 1.0);
    at[1] = 2.0 * radius * (2.0 * b - 1.0);
    at[2] = knife;
}

/* How far the sausage is fed: by a slice before each stroke */
static double fed(const scene *s, double from, double each) {
    double all = 0.0;
    int i;
    for (i = 0; i < SLICES; i++) all += thickness * scene_share(s, s->frame, from + i * each, from + (i + 0.35) * each);
    return all;
}

static void check_slices(scene *s) {
    const double expected = s->volume * thickness / length;
    double below = -HUGE_VAL;
    uint32_t f, next = 0, order[SLICES + 1];
    for (f = 0; f < s->view.fragment_count && f <= SLICES; f++) { /* as they were in the sausage, the lowest first */
        uint32_t i;
        for (i = next++; i > 0 && s->view.fragment_center[3 * order[i - 1] + 2] > s->view.fragment_center[3 * f + 2];
             i--)
            order[i] = order[i - 1];
        order[i] = f;
    }
    for (f = 0; f < SLICES && f < next; f++) {
        const double volume = s->view.fragment_volume[order[f]], height = scene_motion(s, order[f]).center[2];
        scene_check(s, fabs(volume / expected - 1.0) < 0.15, "slice %lu: %.2f of what was fed (0.85 to 1.15)",
                    (unsigned long)f + 1, volume / expected);
        scene_check(s, height > below + 0.25 * thickness, "its centre lies at %.4f m (above the one before)",
                    height + drop);
        below = height;
    }
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "sausage",
                             .about = "A sausage is sliced, and the slices fall one on the other.",
                             .mesh = "grid:6,6,16",
                             .small_mesh = "grid:3,3,8",
                             .frames = 480,
                             .small_frames = 240,
                             .least_frames = 120};
    const double from = 0.02, each = 0.18;
    double pose[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    scene s;
    touching on;
    scene_blade blade;
    int i;
    scene_open(&s, &desc, argc, argv);
    shape_sausage(&s, s.small ? 3 : 6, s.small ? 8 : 16);
    s.body_desc.young = 2e5;
    s.body_desc.poisson = 0.4;
    s.step.dt = 2.0 / s.frames;
    s.step.sleep_speed = 0.01;
    s.step.sleep_time = 0.1;
    s.step.region_poses = pose;
    scene_make(&s);
    scene_hold(&s, 2, 1, knife + 0.9 * length);
    scene_look(&s);
    touching_begin(&s, &on, 0.5, knife - drop);
    blade = scene_make_blade(&s, NULL);
    while (s.frame < s.frames) {
        for (i = 0; i < SLICES; i++)
            scene_stroke(&s, &blade, knife_point, NULL, 6, from + (i + 0.4) * each, from + (i + 0.9) * each);
        pose[11] = -fed(&s, from, each);
        scene_step(&s);
        touching_look(&s, &on);
    }
    scene_check(&s, s.view.fragment_count == SLICES + 1, "pieces: %lu (%d)", (unsigned long)s.view.fragment_count,
                SLICES + 1);
    check_slices(&s);
    touching_check_depths(&s, &on, 0.3, 0.05);
    touching_check_rest(&s, &on);
    scene_check_whole(&s);
    return scene_close(&s);
}
