/* armadillo: hung up by its limbs, cut by surfaces of low and high frequency, smooth and sharp (RXFEM, section 6, Fig.
   13 right).

   55k tetrahedra of St. Venant-Kirchhoff material, steps of 5 ms. Hands and feet are held, gravity pulls at the back
   (along z). A zigzag, a long wave and a bumpy sheet cross each other in the trunk and end inside it; short waves take
   the tail off, spikes part the right thigh, so that the trunk swings down from three limbs. RXFEM gives neither size
   nor stiffness: 1.51 m and 60 kPa let the cuts gape. */
#include "scene.h"

enum { BLADES = 5 };

static const double tall = 1.51; /* m */

typedef enum profile { WAVE, ZIGZAG, BUMPS, SPIKES } profile;

typedef struct blade {
    double corner[3], along[3], inward[3]; /* of the flat sheet that is bent, m; it advances along `along` */
    uint32_t bent;                         /* the axis along which it is bent */
    profile kind;
    double amplitude, waves; /* m; waves: along and, of SPIKES, inward */
    uint32_t columns, rows;
    double from, to; /* shares of the run */
} blade;

/* clang-format off */
static const blade blades[BLADES] = {
    {{-0.40, 0.42, 0.50}, {0.80, 0, 0}, {0, 0, -0.44}, 1, ZIGZAG, 0.035, 10, 80, 8, 0.02, 0.20},
    {{0.50, 0.24, 0.50}, {-0.50, 0, 0}, {0, 0, -0.85}, 1, WAVE, 0.040, 1.5, 60, 6, 0.10, 0.28},
    {{0.08, 0.95, 0.50}, {0, -0.85, 0}, {0, 0, -0.40}, 0, BUMPS, 0.025, 0, 60, 20, 0.20, 0.40},
    {{-0.15, -0.15, 0.40}, {0.30, 0, 0}, {0, 0.35, 0}, 2, WAVE, 0.020, 8, 80, 4, 0.30, 0.45},
    {{0.07, -0.10, -0.35}, {0.45, 0, 0}, {0, 0, 0.80}, 1, SPIKES, 0.040, 7, 56, 56, 0.42, 0.55}};
/* clang-format on */

/* A triangle wave of period 1, from -1 to 1 */
static double teeth(double t) { return 4.0 * fabs(t - floor(t + 0.5)) - 1.0; }

static double height(const blade *of, double a, double b) {
    switch (of->kind) {
    case WAVE: return sin(6.283185307179586 * of->waves * a);
    case ZIGZAG: return teeth(of->waves * a);
    case BUMPS: return scene_noise((uint32_t)(a * of->columns + 0.5), (uint32_t)(b * of->rows + 0.5));
    default: return teeth(of->waves * a) * teeth(of->waves * b);
    }
}

static void blade_point(const void *user, double a, double b, double *x) {
    const blade *of = (const blade *)user;
    int i;
    for (i = 0; i < 3; i++) x[i] = of->corner[i] + a * of->along[i] + b * of->inward[i];
    x[of->bent] += of->amplitude * height(of, a, b);
}

static void make_tall(scene *s) {
    double low[3], high[3], scale;
    scene_bounds(s, low, high);
    scale = tall / (high[1] - low[1]);
    scene_scale(s, scale, scale, scale);
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "armadillo",
                             .about = "An armadillo hung up by its limbs is cut by smooth and sharp surfaces.",
                             .mesh = "armadillo",
                             .small_mesh = "armadillo:8",
                             .any_mesh = 1,
                             .frames = 300,
                             .small_frames = 80,
                             .least_frames = 80};
    const gx_region limbs[3] = {gx_region_half_space(1, -1, -0.42), gx_region_half_space(0, -1, -0.48),
                                gx_region_half_space(0, 1, 0.48)};
    const gx_material material = {{GXS_ST_VENANT_KIRCHHOFF, 6e4, 0.4, 0.0, NULL, NULL}, 1000.0};
    scene s;
    scene_sheet sheets[BLADES];
    unsigned long divided, pieces;
    double gap, largest;
    int i;
    scene_open(&s, &desc, argc, argv);
    make_tall(&s);
    s.body_desc.materials = &material;
    s.body_desc.material_count = 1;
    s.step.dt = 0.005;
    s.step.gravity[2] = 9.81;
    scene_make(&s);
    scene_hold_all(&s, limbs, 3);
    scene_settle(&s, 1e-4);
    for (i = 0; i < BLADES; i++)
        sheets[i] = scene_make_sheet(&s, blades[i].columns, blades[i].rows, blade_point, &blades[i]);
    for (; s.frame < s.frames; scene_step(&s))
        for (i = 0; i < BLADES; i++) scene_advance(&s, &sheets[i], blades[i].from, blades[i].to);
    divided = (unsigned long)scene_divided_elements(&s);
    pieces = (unsigned long)scene_fragments_above(&s, 1e-3);
    gap = scene_mean_gap(&s, 0.02);
    largest = scene_largest_stretch(&s);
    scene_say(&s, "elements cut: %lu", divided);
    scene_check(&s, pieces == 3, "fragments: %lu and %lu splinters (3: trunk, leg, tail)", pieces,
                (unsigned long)s.view.fragment_count - pieces);
    scene_check(&s, gap > 0.01, "faces of the cuts apart: %.3f m on average (more than 0.01 m)", gap);
    scene_check(&s, largest < 3.0, "largest stretch: %.2f (below 3: nothing drifts away)", largest);
    scene_check_body(&s);
    for (i = 0; i < BLADES; i++) scene_drop_sheet(&sheets[i]);
    return scene_close(&s);
}
