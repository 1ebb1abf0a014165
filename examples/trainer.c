/* trainer: much of the library at once, as in a trainer for surgeons. An organ of three materials, made from surfaces,
   breathes: what holds its back moves. Pieces touch each other, a tray and two tools. A hand goes through a round of
   15 s at 60 frames a second (--small: 20), again and again: it slices a lobe off with a blade in space, peels the
   tumour and drops it into the tray, slices the other side; the body then goes back to before the round. In the middle
   of a stroke the body is saved, and one that is loaded goes on for a while with the same bits.

   --frames 36000: ten minutes. */
#include "organ.h"

enum { SECONDS = 15 /* of a round */, TWIN_STEPS = 3, TOOLS = 3, EDGE = 4 };

typedef struct exercise {
    double whole[MATERIALS]; /* m3, before any cut */
    gx_body *before;         /* as it was when the round began */
    gx_anchor anchor;
    gxs_spring spring;
    double grip[3], poses[12];
    gx_collider tools[TOOLS];
    gx_collider_load loads[TOOLS];
    double *seconds; /* of each frame */
    double drift;    /* of a material's volume, as a share: the largest */
    double deepest;  /* m: overlap */
    double farthest; /* m: of a copy from where it was at rest */
    size_t first_memory, fragments_wrong, specks, twins_wrong, twins;
    uint32_t rounds, rate; /* frames a second */
    uint64_t hash;         /* of the states at the ends of rounds */
} exercise;

/* A step of the hand: from when to when, in seconds of the round */
static double share_of(double time, double from, double to) {
    return fmin(1.0, fmax(0.0, (time - from) / (to - from)));
}

/* The edge of the blade: an upright line at x, which goes from the front to the back */
static void place_edge(double x, double share, double edge[3 * EDGE]) {
    int i;
    for (i = 0; i < EDGE; i++) {
        edge[3 * i] = x;
        edge[3 * i + 1] = -0.16 + 0.32 * share;
        edge[3 * i + 2] = -0.25 + 0.5 * i / (EDGE - 1);
    }
}

/* Ground, a ball that presses from above, a rod that strokes the front */
static void move_tools(exercise *on, double time) {
    static const uint32_t kinds[TOOLS] = {GX_COLLIDER_PLANE, GX_COLLIDER_SPHERE, GX_COLLIDER_CAPSULE};
    const double swing = 2.0 * 3.141592653589793 / 5.0, at[TOOLS][3] = {{0, 0, -0.2},
                                                                        {0.03, 0.0, 0.085 + 0.02 * cos(swing * time)},
                                                                        {0.1 * sin(swing * time), -0.13, -0.02}};
    const double speed[TOOLS][3] = {
        {0, 0, 0}, {0, 0, -0.02 * swing * sin(swing * time)}, {0.1 * swing * cos(swing * time), 0, 0}};
    int i, k;
    memset(on->tools, 0, sizeof on->tools);
    for (i = 0; i < TOOLS; i++) {
        gx_collider *tool = &on->tools[i];
        tool->id = (uint32_t)i;
        tool->kind = kinds[i];
        tool->size[0] = i == 1 ? 0.03 : 0.015;
        tool->size[1] = 0.05;
        tool->friction = 0.3;
        for (k = 0; k < 3; k++) {
            tool->pose[5 * k] = 1.0;
            tool->pose[4 * k + 3] = at[i][k];
            tool->velocity[k] = speed[i][k];
        }
    }
}

/* What holds the back goes to and fro. */
static void breathe(exercise *on, double time) {
    int k;
    memset(on->poses, 0, sizeof on->poses);
    for (k = 0; k < 3; k++) on->poses[5 * k] = 1.0;
    on->poses[7] = 0.004 * sin(2.0 * 3.141592653589793 * time / 4.0);
}

/* Saves the body, loads it, and lets both take the same steps: the bits must be the same. */
static void compare_twin(scene *s, exercise *on, scene_blade *blade, double x, double time) {
    gx_body_desc desc;
    gx_body *twin = NULL;
    gx_view view;
    void *bytes;
    size_t size;
    int i;
    memset(&desc, 0, sizeof desc);
    scene_must(s, gx_body_save(s->body, NULL, 0, &size, &s->failure), "save");
    bytes = scene_array(s, size, 1);
    scene_must(s, gx_body_save(s->body, bytes, size, &size, &s->failure), "save");
    scene_must(s, gx_body_load(bytes, size, &desc, &twin, &s->failure), "load");
    free(bytes);
    for (i = 1; i <= TWIN_STEPS; i++) {
        double edge[3 * EDGE];
        gx_step_desc step = s->step;
        step.clock = NULL;
        place_edge(x, share_of(time + (double)i / on->rate, 1.0, 3.0), edge);
        scene_must(s, gx_blade_move(gx_body_blade(twin, 0), edge, EDGE, NULL, 0, NULL, &s->failure), "twin");
        scene_must(s, gx_body_step(twin, &step, NULL, &s->failure), "twin");
        scene_must(s, gx_body_view(twin, &view, &s->failure), "twin"); /* which numbers fragments, as the scene does */
        scene_move_blade(s, blade, edge, EDGE);
        scene_step(s);
    }
    on->twins++;
    on->twins_wrong += gx_body_state_hash(twin) != gx_body_state_hash(s->body);
    gx_body_destroy(twin);
}

/* The tumour comes off, and a spring takes hold in its middle. */
static void grasp(scene *s, exercise *on) {
    gx_hit hit;
    size_t hits;
    scene_peel(s, TUMOUR);
    scene_look(s);
    memcpy(on->grip, scene_motion(s, organ_fragment(s, TUMOUR)).center, sizeof on->grip);
    scene_must(s, gx_body_locate_all(s->body, on->grip, &hit, 1, &hits, &s->failure), "locate");
    scene_must(s, gx_hit_anchor(s->body, &hit, &on->anchor, &s->failure), "spring");
    on->spring.stiffness = 150.0;
    s->step.springs = &on->spring;
    s->step.spring_anchors = &on->anchor;
    s->step.spring_count = 1;
}

/* What a frame shows */
static void watch(scene *s, exercise *on, double seconds) {
    gx_contact contacts[64];
    size_t count, i;
    const gx_result result = gx_body_contacts(s->body, contacts, 64, &count, NULL);
    if (result == GX_OK || result == GX_ERROR_CAPACITY)
        for (i = 0; i < count && i < 64; i++) on->deepest = fmax(on->deepest, contacts[i].depth);
    for (i = 0; i < 3 * s->view.copy_count; i++) on->farthest = fmax(on->farthest, fabs(s->view.displacement[i]));
    on->seconds[s->frame - 1] = seconds;
}

/* Moves the blade through the body where the stroke from `from` to `to` seconds is at work. */
static void slice(scene *s, exercise *on, scene_blade *blade, double x, double time, double from, double to) {
    double edge[3 * EDGE];
    if (time < from || time > to + 0.5 / on->rate) return;
    place_edge(x, share_of(time, from, to), edge);
    scene_move_blade(s, blade, edge, EDGE);
    if (time + 0.5 / on->rate >= to) scene_lift_blade(s, blade);
}

static void expect_fragments(scene *s, exercise *on, size_t count) {
    const size_t pieces = scene_fragments_above(s, 1e-6);
    on->specks += s->view.fragment_count - pieces;
    if (pieces == count) return;
    scene_say(s, "frame %lu: %lu pieces (%lu)", (unsigned long)s->frame, (unsigned long)pieces, (unsigned long)count);
    on->fragments_wrong++;
}

/* At the end of a round: volumes, memory; back to before it. */
static void end_round(scene *s, exercise *on, scene_blade *blade) {
    double volume[MATERIALS];
    int m;
    organ_measure(s, UINT32_MAX, volume);
    for (m = 0; m < MATERIALS; m++) on->drift = fmax(on->drift, fabs(volume[m] / on->whole[m] - 1.0));
    on->hash = 31 * on->hash + gx_body_state_hash(s->body);
    scene_must(s, gx_body_restore(s->body, on->before, &s->failure), "undo");
    gx_body_destroy(on->before);
    on->before = NULL;
    blade->blade = gx_body_blade(s->body, 0);
    s->step.spring_count = 0;
    s->looked = 0;
    scene_look(s);
    if (on->rounds++ == 0) on->first_memory = s->memory.peak;
}

/* A frame of the hand */
static void practise(scene *s, exercise *on, scene_blade *blade) {
    const uint32_t length = SECONDS * on->rate, at = s->frame % length, turn = s->frame / length % 3;
    const double time = (double)at / on->rate, right = 0.055 + 0.012 * turn, left = -0.095 - 0.005 * turn;
    const double way[3] = {0.02, -0.12, 0.05}, share = share_of(time, 4.0, 7.0);
    int k;
    if (at == 0) scene_must(s, gx_body_clone(s->body, &on->before, &s->failure), "mark");
    if (at == 2 * on->rate) {
        compare_twin(s, on, blade, right, time);
        return;
    }
    slice(s, on, blade, right, time, 1.0, 3.0);
    if (at == 4 * on->rate) {
        expect_fragments(s, on, 2);
        grasp(s, on);
        expect_fragments(s, on, 3);
    }
    if (at == 8 * on->rate) s->step.spring_count = 0;
    for (k = 0; k < 3; k++) on->spring.target[k] = on->grip[k] + share * way[k];
    slice(s, on, blade, left, time, 9.0, 11.0);
    if (at == 12 * on->rate) expect_fragments(s, on, 4);
    scene_step(s);
    if (s->frame % length == 0) end_round(s, on, blade);
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void say_times(scene *s, exercise *on) {
    const uint32_t n = s->frame;
    qsort(on->seconds, n, sizeof *on->seconds, compare_doubles);
    scene_say(s, "frames, ms: median %.1f, 95 %% below %.1f, 99 %% below %.1f, worst %.1f (a frame has 16.7)",
              1e3 * on->seconds[n / 2], 1e3 * on->seconds[n * 95 / 100], 1e3 * on->seconds[n * 99 / 100],
              1e3 * on->seconds[n - 1]);
    scene_say(s, "states at the ends of rounds: %08lx%08lx", (unsigned long)(on->hash >> 32),
              (unsigned long)(on->hash & 0xffffffffu));
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "trainer",
                             .about =
                                 "An organ is sliced, peeled, dropped and made whole again, in contact with tools.",
                             .frames = 60 * SECONDS,
                             .small_frames = 20 * SECONDS,
                             .least_frames = 20 * SECONDS};
    gxio_surface surfaces[MATERIALS];
    gx_contact_desc contact;
    scene_blade blade;
    exercise on;
    scene s;
    int m;
    memset(&on, 0, sizeof on);
    memset(&contact, 0, sizeof contact);
    scene_open(&s, &desc, argc, argv);
    organ_surfaces(&s, surfaces);
    on.rate = s.small ? 20 : 60;
    s.step.dt = 1.0 / on.rate;
    s.step.mass_damping = 1.0;
    s.body_desc.affine_below = 1.0;
    organ_make(&s, surfaces, s.small ? 6 : 16);
    scene_hold(&s, 1, 1, 0.05);
    scene_look(&s);
    organ_measure(&s, UINT32_MAX, on.whole);
    scene_settle(&s, 1e-6);
    contact.friction = 0.3;
    scene_must(&s, gx_body_contact(s.body, &contact, &s.failure), "contact");
    blade = scene_make_blade(&s, NULL);
    on.seconds = (double *)scene_array(&s, s.frames + TWIN_STEPS, sizeof *on.seconds);
    s.step.colliders = on.tools;
    s.step.collider_loads = on.loads;
    s.step.collider_count = TOOLS;
    s.step.region_poses = on.poses;
    while (s.frame < s.frames) {
        const double time = (double)s.frame / on.rate, before = s.sum_frames;
        const uint32_t frame = s.frame;
        move_tools(&on, time);
        breathe(&on, time);
        practise(&s, &on, &blade);
        watch(&s, &on, (s.sum_frames - before) / (s.frame - frame));
    }
    scene_check(&s, on.fragments_wrong == 0, "counts of pieces that are not as the strokes: %lu (0)",
                (unsigned long)on.fragments_wrong);
    scene_check(&s, on.twins_wrong == 0, "loaded bodies that went on otherwise: %lu of %lu (0)",
                (unsigned long)on.twins_wrong, (unsigned long)on.twins);
    scene_check(&s, on.drift <= 1e-12, "volume of a material, by rounds: %.1e off (at most 1e-12)", on.drift);
    scene_check(&s, on.farthest < 2.0, "farthest copy: %.2f m from its place at rest (less than 2 m)", on.farthest);
    scene_check(&s, (double)s.memory.peak <= 1.5 * (double)on.first_memory,
                "memory: %.1f MB at its peak, %.1f after a round (at most 1.5 times)", 1e-6 * (double)s.memory.peak,
                1e-6 * (double)on.first_memory);
    scene_say(&s, "specks that strokes left, below 1e-6 of the body: %lu; deepest overlap: %.4f m",
              (unsigned long)on.specks, on.deepest);
    say_times(&s, &on);
    for (m = 0; m < MATERIALS; m++) gxio_surface_release(&surfaces[m]);
    gx_body_destroy(on.before);
    free(on.seconds);
    return scene_close(&s);
}
