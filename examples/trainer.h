/* trainer.h: the hand of the scene `trainer`. What it does in a round of SECONDS, by the clock of the round:

      0 s          the body is marked, to go back to
      1 to 3       a stroke takes the right lobe off
      3.4 to 5.6   two strokes that cross take a wedge out of the front
      5.8          the tumour is peeled along its interface; a spring takes hold of it and one of the wedge,
                   they pull until 7.4, and both fall at 8
      8.2          a drill takes three bites
      9            the body is marked; a stroke until 10 is a slip, and is undone at 10.2
      10.4 to 11.4 a stroke takes the left rim off
      11.8 to 12.6 a stroke beside it ends in the body: the flap is peeled away by a spring until 14.4
      15           back to the mark

   Strokes go from front to back, upright, in space, while what holds the back breathes and two tools press. A twin of
   the body, loaded from saved bytes or cloned, at times does the same for a while: in the middle of strokes, with
   memory that runs out, with poses of tools that are none. What it shows must be what the body shows, bit by bit.

   contents
     >>strokes     where the blade goes, and when
     >>witnesses   points of the material that tell what each stroke should have separated
     >>tools       what presses, what holds
     >>twin        another body that does the same
     >>hand        what happens in a frame
     >>report      what came of it */
#ifndef TRAINER_H
#define TRAINER_H

#include "organ.h"

enum { SECONDS = 15 /* of a round */, TURNS = 3 /* rounds that differ */, EDGE = 4, TOOLS = 3, REGIONS = 3 };
enum { LOBE, WEDGE_LEFT, WEDGE_RIGHT, SLIP, RIM, FLAP, STROKES };
enum { PHASE_BLADE, PHASE_MODEL, PHASE_SOLVE, PHASE_SKIN, PHASE_FRAME, PHASES };

/* Seen from above: the blade goes straight, upright, from one point to another. */
typedef struct trainer_stroke {
    double begin, end;      /* s, of the round */
    double from[2], way[2]; /* m */
} trainer_stroke;

/* A point of the material. Before a stroke passes it, it is known how far off the stroke's plane it is in space. */
typedef struct trainer_witness {
    gx_anchor anchor;
    uint32_t material, doubtful; /* 1: it is so near to a stroke that either side is right */
    double off[STROKES];         /* m: to the left of the stroke, 0: not known yet */
    uint8_t passed[STROKES];
} trainer_witness;

typedef struct trainer_twin {
    gx_body *body;     /* NULL: there is none */
    uint32_t left;     /* frames to go */
    int scarce;        /* its memory runs out, again and again */
    uint32_t attempts; /* calls for which memory ran out: varies at which allocation that is */
} trainer_twin;

typedef struct trainer {
    uint32_t rate;           /* frames a second */
    double size;             /* m: mean of the elements */
    double whole[MATERIALS]; /* m3, before any cut */
    double bored;            /* m3: taken by the drill in this round */
    gx_body *mark, *slip;    /* as it was when the round, the slip began */
    trainer_stroke strokes[STROKES];
    trainer_witness *witnesses;
    size_t witness_count;
    gx_anchor anchors[2];
    gxs_spring springs[2];
    double grips[2][3], ways[2][3], pull_begin, pull_end;
    gx_region regions[REGIONS];
    gx_anchor hook;
    double poses[12 * REGIONS];
    gx_collider tools[TOOLS];
    gx_collider_load loads[TOOLS];
    scene_blade blade;
    trainer_twin twin;
    double *seconds[PHASES]; /* of each frame */
    double sums[PHASES];     /* of the scene, at the last frame's end */
    /* what the report judges */
    double drift, tumour, deepest, farthest, fastest;
    size_t first_memory, last_memory, rounds, judged, doubtful, split, bridged, counts_wrong, specks;
    size_t twins, twins_wrong, ran_out, refused, not_refused, harmed, undone_wrong;
    int peeled;    /* the tumour, in this round */
    uint64_t hash; /* of the states at the ends of rounds */
} trainer;

/* ------------------------------------------------------------------------------------------- >>strokes */

static inline void trainer_set_stroke(trainer *on, int which, double begin, double end, double x, double to_x,
                                      double to_y) {
    trainer_stroke *stroke = &on->strokes[which];
    stroke->begin = begin;
    stroke->end = end;
    stroke->from[0] = x;
    stroke->from[1] = -0.16;
    stroke->way[0] = to_x - x;
    stroke->way[1] = to_y + 0.16;
}

static inline void trainer_plan(trainer *on, uint32_t turn) {
    const double right = 0.058 + 0.008 * turn, left = -0.094 - 0.004 * turn;
    trainer_set_stroke(on, LOBE, 1.0, 3.0, right, right, 0.16);
    trainer_set_stroke(on, WEDGE_LEFT, 3.4, 4.4, -0.022, 0.036, 0.03);
    trainer_set_stroke(on, WEDGE_RIGHT, 4.6, 5.6, 0.07, 0.014, 0.03);
    trainer_set_stroke(on, SLIP, 9.0, 10.0, -0.06, -0.06, 0.16);
    trainer_set_stroke(on, RIM, 10.4, 11.4, left, left, 0.16);
    trainer_set_stroke(on, FLAP, 11.8, 12.6, left + 0.008, left + 0.008, 0.02);
}

/* How much of the time from `begin` to `end` is over */
static inline double trainer_share(double time, double begin, double end) {
    return fmin(1.0, fmax(0.0, (time - begin) / (end - begin)));
}

static inline void trainer_place_edge(const trainer_stroke *stroke, double time, double edge[3 * EDGE]) {
    const double share = trainer_share(time, stroke->begin, stroke->end);
    int i, k;
    for (i = 0; i < EDGE; i++) {
        for (k = 0; k < 2; k++) edge[3 * i + k] = stroke->from[k] + share * stroke->way[k];
        edge[3 * i + 2] = -0.12 + 0.37 * i / (EDGE - 1);
    }
}

/* The stroke that is at work, STROKES: none. Its last frame is the first at its end or after. */
static inline int trainer_stroke_now(const trainer *on, double time) {
    int i;
    for (i = 0; i < STROKES; i++)
        if (time >= on->strokes[i].begin && time - 1.0 / on->rate < on->strokes[i].end) return i;
    return STROKES;
}

/* ----------------------------------------------------------------------------------------- >>witnesses */

/* A grid of points, those of them that are in the body */
static inline void trainer_call_witnesses(scene *s, trainer *on) {
    const int n = s->small ? 14 : 28;
    const double spacing = 0.28 / n;
    double *points = (double *)scene_array(s, (size_t)(n * n * n), 3 * sizeof(double));
    gx_hit *hits = (gx_hit *)scene_array(s, (size_t)(n * n * n), sizeof *hits);
    size_t count = 0, i;
    int x, y, z;
    for (x = 0; x < n; x++)
        for (y = 0; y < n; y++)
            for (z = 0; z < n; z++, count++) {
                points[3 * count] = spacing * (x + 0.37) - 0.14;
                points[3 * count + 1] = spacing * (y + 0.41) - 0.14;
                points[3 * count + 2] = spacing * (z + 0.53) - 0.14;
            }
    scene_must(s, gx_body_locate(s->body, points, count, hits, &s->failure), "witnesses");
    on->witnesses = (trainer_witness *)scene_array(s, count, sizeof *on->witnesses);
    for (i = 0; i < count; i++) {
        trainer_witness *w = &on->witnesses[on->witness_count];
        if (hits[i].distance > 0.0) continue;
        scene_must(s, gx_hit_anchor(s->body, &hits[i], &w->anchor, &s->failure), "witness");
        w->material = s->view.cell_material[hits[i].cell];
        on->witness_count++;
    }
    free(points);
    free(hits);
}

static inline void trainer_forget(trainer *on, int from, int to) {
    size_t i;
    int k;
    for (i = 0; i < on->witness_count; i++)
        for (k = from; k < to; k++) {
            on->witnesses[i].off[k] = 0.0;
            on->witnesses[i].passed[k] = 0;
        }
}

/* Where each witness is beside the stroke at work, before the blade comes to its place of this frame */
static inline void trainer_watch_stroke(scene *s, trainer *on, int which, double time) {
    const trainer_stroke *stroke = &on->strokes[which];
    const double length = sqrt(stroke->way[0] * stroke->way[0] + stroke->way[1] * stroke->way[1]);
    const double come = length * trainer_share(time, stroke->begin, stroke->end);
    size_t i;
    for (i = 0; i < on->witness_count; i++) {
        trainer_witness *w = &on->witnesses[i];
        double at[3], x, y, along, off;
        if (w->passed[which]) continue;
        if (gx_body_anchor_point(s->body, &w->anchor, NULL, at, NULL) != GX_OK) continue; /* drilled away */
        if (at[2] < -0.12 || at[2] > 0.25) continue; /* below the blade, or above it */
        x = at[0] - stroke->from[0];
        y = at[1] - stroke->from[1];
        along = (x * stroke->way[0] + y * stroke->way[1]) / length;
        off = (stroke->way[0] * y - stroke->way[1] * x) / length;
        w->passed[which] = along < come;
        if (fabs(off) < 0.1 * on->size || off * w->off[which] < 0.0) w->doubtful = 1;
        w->off[which] = off;
    }
}

/* What a witness should be part of, by the strokes so far. The tumour is a piece of its own once it is peeled. */
static inline uint32_t trainer_label(const trainer *on, const trainer_witness *w) {
    if (on->peeled && w->material == TUMOUR) return 1u << 4;
    return (uint32_t)(w->off[LOBE] < 0.0) | (uint32_t)(w->off[WEDGE_LEFT] < 0.0 && w->off[WEDGE_RIGHT] > 0.0) << 1 |
           (uint32_t)(w->off[SLIP] > 0.0) << 2 | (uint32_t)(w->off[RIM] > 0.0) << 3;
}

/* Fragments and labels must name the same pieces: no fragment with two labels (a bridge), no label in two fragments. */
static inline void trainer_judge(scene *s, trainer *on, size_t expected) {
    enum { LABELS = 32 };
    const size_t pieces = scene_fragments_above(s, 1e-6);
    uint32_t *fragments = scene_copy_fragments(s), of_label[LABELS], i, f;
    uint32_t *label_of = (uint32_t *)scene_array(s, s->view.fragment_count, sizeof *label_of);
    for (i = 0; i < LABELS; i++) of_label[i] = UINT32_MAX;
    for (f = 0; f < s->view.fragment_count; f++) label_of[f] = UINT32_MAX;
    for (i = 0; i < on->witness_count; i++) {
        const trainer_witness *w = &on->witnesses[i];
        const uint32_t label = trainer_label(on, w);
        gxs_point point;
        if (w->doubtful) on->doubtful++;
        if (w->doubtful || gx_body_anchor_point(s->body, &w->anchor, &point, NULL, NULL) != GX_OK) continue;
        f = fragments[point.copies ? point.copies[0] : point.copy[0]];
        if (label_of[f] == UINT32_MAX) label_of[f] = label;
        if (of_label[label] == UINT32_MAX) of_label[label] = f;
        on->bridged += label_of[f] != label;
        on->split += of_label[label] != f;
        on->judged++;
    }
    on->specks += s->view.fragment_count - pieces;
    on->counts_wrong += pieces != expected;
    if (pieces != expected)
        scene_say(s, "frame %lu: %lu pieces (%lu)", (unsigned long)s->frame, (unsigned long)pieces,
                  (unsigned long)expected);
    free(fragments);
    free(label_of);
}

/* The witness of a piece, by its label, that is nearest to a point of the body at rest */
static const gx_anchor *trainer_nearest(const trainer *on, uint32_t label, const double at[3]) {
    const trainer_witness *best = &on->witnesses[0];
    double least = HUGE_VAL;
    size_t i;
    int k;
    for (i = 0; i < on->witness_count; i++) {
        const trainer_witness *w = &on->witnesses[i];
        double distance = 0.0;
        if (trainer_label(on, w) != label) continue;
        for (k = 0; k < 3; k++) distance += pow(w->anchor.position[k] - at[k], 2.0);
        if (distance < least) best = w;
        least = fmin(least, distance);
    }
    return &best->anchor;
}

/* --------------------------------------------------------------------------------------------- >>tools */

/* Ground, a ball that presses from above, a rod that strokes the front */
static inline void trainer_move_tools(trainer *on, double time) {
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

/* Two boxes at the back, and a hook in the middle of the top, which is an anchor */
static inline void trainer_hold(scene *s, trainer *on) {
    const double left[2][3] = {{-0.2, 0.05, -0.2}, {0.01, 0.2, 0.2}},
                 right[2][3] = {{-0.01, 0.05, -0.2}, {0.2, 0.2, 0.2}};
    const double top[3] = {-0.035, 0.02, 0.03};
    gx_hit hit;
    scene_must(s, gx_body_locate(s->body, top, 1, &hit, &s->failure), "hook");
    scene_must(s, gx_hit_anchor(s->body, &hit, &on->hook, &s->failure), "hook");
    on->regions[0] = gx_region_box(left[0], left[1]);
    on->regions[1] = gx_region_box(right[0], right[1]);
    on->regions[2].kind = GX_REGION_ANCHORS;
    on->regions[2].anchors = &on->hook;
    on->regions[2].anchor_count = 1;
    scene_hold_all(s, on->regions, REGIONS);
}

/* The back goes to and fro, the hook up and down. */
static inline void trainer_breathe(trainer *on, double time) {
    const double breath = 0.004 * sin(2.0 * 3.141592653589793 * time / 4.0);
    int i, k;
    memset(on->poses, 0, sizeof on->poses);
    for (i = 0; i < REGIONS; i++) {
        for (k = 0; k < 3; k++) on->poses[12 * i + 5 * k] = 1.0;
        on->poses[12 * i + (i == 2 ? 11 : 7)] = breath;
    }
}

/* A drill, eight-sided, upright: it takes what it covers now. */
static inline void trainer_drill(scene *s, trainer *on, double z) {
    enum { SIDES = 8 };
    double vertices[3 * (2 * SIDES + 2)];
    uint32_t triangles[3 * 4 * SIDES], *t = triangles, i;
    gx_surface tool;
    gx_cut_report report;
    for (i = 0; i < 2 * SIDES + 2; i++) {
        const double angle = 2.0 * 3.141592653589793 * (i % SIDES) / SIDES, radius = i < 2 * SIDES ? 0.012 : 0.0;
        vertices[3 * i] = -0.068 + radius * cos(angle);
        vertices[3 * i + 1] = 0.022 + radius * sin(angle);
        vertices[3 * i + 2] = (i < SIDES || i == 2 * SIDES) ? z : 0.2;
    }
    for (i = 0; i < SIDES; i++, t += 12) {
        const uint32_t next = (i + 1) % SIDES;
        const uint32_t of_side[12] = {i,    next, SIDES + next,  i,         SIDES + next, SIDES + i, 2 * SIDES,
                                      next, i,    2 * SIDES + 1, SIDES + i, SIDES + next};
        memcpy(t, of_side, sizeof of_side);
    }
    memset(&tool, 0, sizeof tool);
    tool.vertices = vertices;
    tool.vertex_count = 2 * SIDES + 2;
    tool.triangles = triangles;
    tool.triangle_count = 4 * SIDES;
    scene_must(s, gx_body_carve(s->body, &tool, &report, &s->failure), "drill");
    on->bored += report.removed_volume;
    s->looked = 0;
    scene_look(s);
}

/* ---------------------------------------------------------------------------------------------- >>twin */

/* A call on the twin: with scarce memory it fails some times first, and must leave the twin as it was. */
typedef gx_result (*trainer_call)(gx_body *body, void *arguments);

static inline gx_result trainer_try(scene *s, trainer *on, trainer_call call, void *arguments) {
    gx_body *twin = on->twin.body;
    const uint64_t before = gx_body_state_hash(twin);
    uint32_t after = 1 + on->twin.attempts % 7;
    gx_result result;
    while (on->twin.scarce) {
        s->memory.left = after;
        result = call(twin, arguments);
        s->memory.left = 0;
        if (result != GX_ERROR_MEMORY) return result;
        on->ran_out++;
        on->twin.attempts++;
        on->harmed += gx_body_state_hash(twin) != before;
        after = 2 * after + 1;
    }
    return call(twin, arguments);
}

static inline gx_result trainer_twin_blade(gx_body *body, void *arguments) {
    return gx_blade_move(gx_body_blade(body, 0), (const double *)arguments, EDGE, NULL, 0, NULL, NULL);
}

static inline gx_result trainer_twin_step(gx_body *body, void *arguments) {
    return gx_body_step(body, (const gx_step_desc *)arguments, NULL, NULL);
}

static inline gx_result trainer_twin_view(gx_body *body, void *arguments) {
    return gx_body_view(body, (gx_view *)arguments, NULL);
}

/* Poses that are none, and numbers that are none, must be refused by the name of the field. */
static inline void trainer_provoke(trainer *on, const gx_step_desc *step) {
    const uint64_t before = gx_body_state_hash(on->twin.body);
    int i;
    for (i = 0; i < 4; i++) {
        gx_collider tools[TOOLS];
        gx_step_desc wrong = *step;
        gx_failure failure;
        gx_result result;
        memcpy(tools, on->tools, sizeof tools);
        if (i == 0) tools[1].pose[7] = NAN;
        if (i == 1) tools[1].pose[0] = 2.0;
        if (i == 2) tools[2].velocity[0] = HUGE_VAL;
        if (i == 3) tools[2].size[0] = -1.0;
        wrong.colliders = tools;
        result = gx_body_step(on->twin.body, &wrong, NULL, &failure);
        on->refused += result != GX_OK && failure.field != NULL && strncmp(failure.field, "colliders", 9) == 0 &&
                       failure.index == (i < 2 ? 1u : 2u);
        on->not_refused += result == GX_OK;
        on->harmed += gx_body_state_hash(on->twin.body) != before;
    }
}

/* The body as it is between two frames: loaded from its bytes, or cloned */
static inline void trainer_make_twin(scene *s, trainer *on, int load, int scarce) {
    on->twin.left = 3;
    on->twin.scarce = scarce;
    if (load) {
        gx_body_desc desc = {0};
        void *bytes;
        size_t size;
        desc.allocator = s->body_desc.allocator;
        scene_must(s, gx_body_save(s->body, NULL, 0, &size, &s->failure), "save");
        bytes = scene_array(s, size, 1);
        scene_must(s, gx_body_save(s->body, bytes, size, &size, &s->failure), "save");
        scene_must(s, gx_body_load(bytes, size, &desc, &on->twin.body, &s->failure), "load");
        free(bytes);
    } else
        scene_must(s, gx_body_clone(s->body, &on->twin.body, &s->failure), "clone");
}

/* The twin does what the body has done in this frame. After its last frame both must be equal. */
static inline void trainer_follow(scene *s, trainer *on, const double *edge) {
    gx_step_desc step = s->step;
    gx_view view;
    if (on->twin.body == NULL) return;
    step.clock = NULL;
    step.collider_loads = NULL;
    if (on->twin.scarce) trainer_provoke(on, &step);
    if (edge) scene_must(s, trainer_try(s, on, trainer_twin_blade, (void *)(uintptr_t)edge), "twin: blade");
    scene_must(s, trainer_try(s, on, trainer_twin_step, &step), "twin: step");
    scene_must(s, trainer_try(s, on, trainer_twin_view, &view), "twin: view");
    if (--on->twin.left > 0) return;
    on->twins++;
    on->twins_wrong += gx_body_state_hash(on->twin.body) != gx_body_state_hash(s->body);
    gx_body_destroy(on->twin.body);
    on->twin.body = NULL;
}

/* ---------------------------------------------------------------------------------------------- >>hand */

/* Springs take hold of pieces by their labels, near points of the body at rest. */
static inline void trainer_pull(scene *s, trainer *on, size_t count, const uint32_t labels[], const double at[][3],
                                const double ways[][3], double begin, double end) {
    size_t i;
    for (i = 0; i < count; i++) {
        on->anchors[i] = *trainer_nearest(on, labels[i], at[i]);
        scene_must(s, gx_body_anchor_point(s->body, &on->anchors[i], NULL, on->grips[i], &s->failure), "spring");
        memcpy(on->ways[i], ways[i], sizeof on->ways[i]);
        on->springs[i].stiffness = 150.0;
    }
    on->pull_begin = begin;
    on->pull_end = end;
    s->step.springs = on->springs;
    s->step.spring_anchors = on->anchors;
    s->step.spring_count = count;
}

/* Volumes of the tumour's piece: all of the tumour, and nothing else. Returns how far it is off, as a share. */
static inline double trainer_tumour_error(const scene *s, const trainer *on) {
    double volume[MATERIALS];
    organ_measure(s, organ_fragment(s, TUMOUR), volume);
    return fabs(volume[TUMOUR] / on->whole[TUMOUR] - 1.0) + (volume[FLESH] + volume[VESSEL]) / on->whole[TUMOUR];
}

static inline void trainer_grasp(scene *s, trainer *on) {
    static const uint32_t labels[2] = {1u << 4, 1u << 1};
    static const double at[2][3] = {{-0.03, -0.052, 0.028}, {0.024, -0.03, 0.0}};
    static const double ways[2][3] = {{0.0, -0.12, 0.06}, {0.05, -0.14, 0.02}};
    scene_peel(s, TUMOUR);
    scene_look(s);
    on->peeled = 1;
    on->tumour = fmax(on->tumour, trainer_tumour_error(s, on));
    trainer_judge(s, on, 4);
    trainer_pull(s, on, 2, labels, at, ways, 5.8, 7.4);
}

static inline void trainer_grasp_flap(scene *s, trainer *on) {
    static const uint32_t labels[1] = {0};
    static const double ways[1][3] = {{-0.05, -0.05, 0.03}};
    const double at[1][3] = {{on->strokes[FLAP].from[0] - 0.004, -0.035, 0.0}};
    trainer_pull(s, on, 1, labels, at, ways, 12.6, 14.0);
}

/* Puts the body back to a mark, which goes. */
static inline void trainer_go_back(scene *s, trainer *on, gx_body **mark) {
    const uint64_t then = gx_body_state_hash(*mark);
    scene_must(s, gx_body_restore(s->body, *mark, &s->failure), "undo");
    on->undone_wrong += gx_body_state_hash(s->body) != then;
    gx_body_destroy(*mark);
    *mark = NULL;
    on->blade.blade = gx_body_blade(s->body, 0);
    s->looked = 0;
    scene_look(s);
}

static inline void trainer_begin_round(scene *s, trainer *on) {
    scene_must(s, gx_body_clone(s->body, &on->mark, &s->failure), "mark");
    trainer_plan(on, (uint32_t)(on->rounds % TURNS));
    trainer_forget(on, 0, STROKES);
    on->peeled = 0;
    on->bored = 0.0;
}

static inline void trainer_end_round(scene *s, trainer *on) {
    double volume[MATERIALS], sum = 0.0, whole = 0.0;
    size_t i;
    int m;
    organ_measure(s, UINT32_MAX, volume);
    for (m = 0; m < MATERIALS; m++) {
        sum += volume[m];
        whole += on->whole[m];
    }
    on->drift = fmax(on->drift, fabs((sum + on->bored) / whole - 1.0));
    on->hash = 31 * on->hash + gx_body_state_hash(s->body);
    trainer_go_back(s, on, &on->mark);
    for (i = 0; i < on->witness_count; i++) on->witnesses[i].doubtful = 0;
    s->step.spring_count = 0;
    on->last_memory = s->memory.peak;
    if (on->rounds++ == 0) on->first_memory = s->memory.peak;
}

/* Is this the frame of a time of the round? */
static inline int trainer_is_time(const trainer *on, uint32_t frame, double time) {
    return frame == (uint32_t)(time * on->rate + 0.5);
}

/* What does not take time: marks, counts, springs, drill, twins */
static inline void trainer_attend(scene *s, trainer *on, uint32_t frame) {
    static const struct {
        double time;
        size_t pieces;
    } judged[] = {{3.2, 2}, {5.7, 3}, {8.9, 4}, {10.1, 5}, {11.6, 5}, {12.6, 5}, {14.4, 5}};
    static const struct {
        double time;
        int load, scarce;
    } twins[] = {{2.0, 1, 0}, {4.0, 0, 1}, {7.0, 1, 1}, {12.2, 0, 0}};
    size_t i;
    if (frame == 0) trainer_begin_round(s, on);
    if (trainer_is_time(on, frame, 9.0)) scene_must(s, gx_body_clone(s->body, &on->slip, &s->failure), "mark");
    if (trainer_is_time(on, frame, 5.8)) trainer_grasp(s, on);
    for (i = 0; i < 3; i++)
        if (trainer_is_time(on, frame, 8.2 + 0.2 * (double)i)) trainer_drill(s, on, 0.04 - 0.015 * (double)i);
    for (i = 0; i < sizeof judged / sizeof *judged; i++)
        if (trainer_is_time(on, frame, judged[i].time)) trainer_judge(s, on, judged[i].pieces);
    if (trainer_is_time(on, frame, 10.2)) {
        trainer_go_back(s, on, &on->slip);
        trainer_forget(on, SLIP, SLIP + 1);
    }
    if (trainer_is_time(on, frame, 12.7)) trainer_grasp_flap(s, on);
    if (trainer_is_time(on, frame, 8.0) || trainer_is_time(on, frame, 14.4)) s->step.spring_count = 0;
    for (i = 0; i < sizeof twins / sizeof *twins; i++)
        if (trainer_is_time(on, frame, twins[i].time)) trainer_make_twin(s, on, twins[i].load, twins[i].scarce);
}

/* A frame: what holds, tools, springs, blade, step, a look at what there is */
static inline void trainer_frame(scene *s, trainer *on) {
    const uint32_t frame = s->frame % (SECONDS * on->rate);
    const double time = (double)frame / on->rate;
    double edge[3 * EDGE];
    int stroke, k;
    size_t i;
    trainer_attend(s, on, frame);
    trainer_move_tools(on, (double)s->frame / on->rate);
    trainer_breathe(on, (double)s->frame / on->rate);
    for (i = 0; i < s->step.spring_count; i++)
        for (k = 0; k < 3; k++)
            on->springs[i].target[k] =
                on->grips[i][k] + trainer_share(time, on->pull_begin, on->pull_end) * on->ways[i][k];
    stroke = trainer_stroke_now(on, time);
    if (stroke != STROKES) {
        trainer_watch_stroke(s, on, stroke, time);
        trainer_place_edge(&on->strokes[stroke], time, edge);
        scene_move_blade(s, &on->blade, edge, EDGE);
        if (time >= on->strokes[stroke].end) scene_lift_blade(s, &on->blade);
    }
    scene_step(s);
    trainer_follow(s, on, stroke != STROKES ? edge : NULL);
    if (s->frame % (SECONDS * on->rate) == 0) trainer_end_round(s, on);
}

/* What a frame shows */
static inline void trainer_watch(scene *s, trainer *on) {
    const double now[PHASES] = {s->sum_frames - s->sum[SCENE_MODEL] - s->sum[SCENE_LINEARISE] - s->sum[SCENE_PREPARE] -
                                    s->sum[SCENE_SOLVE] - s->sum[SCENE_FORCES] - s->sum[SCENE_SKIN],
                                s->sum[SCENE_MODEL],
                                s->sum[SCENE_LINEARISE] + s->sum[SCENE_PREPARE] + s->sum[SCENE_SOLVE] +
                                    s->sum[SCENE_FORCES],
                                s->sum[SCENE_SKIN], s->sum_frames};
    gx_contact contacts[64];
    size_t count, i;
    const gx_result result = gx_body_contacts(s->body, contacts, 64, &count, NULL);
    if (result == GX_OK || result == GX_ERROR_CAPACITY)
        for (i = 0; i < count && i < 64; i++) on->deepest = fmax(on->deepest, contacts[i].depth);
    for (i = 0; i < 3 * s->view.copy_count; i++) {
        on->farthest = fmax(on->farthest, fabs(s->view.displacement[i]));
        on->fastest = fmax(on->fastest, fabs(s->view.velocity[i]));
    }
    for (i = 0; i < PHASES; i++) {
        on->seconds[i][s->frame - 1] = now[i] - on->sums[i];
        on->sums[i] = now[i];
    }
}

/* -------------------------------------------------------------------------------------------- >>report */

static inline double trainer_mean_size(const scene *s) {
    return cbrt(6.0 * scene_mesh_volume(s) / (double)s->mesh.element_count);
}

static const scene_desc trainer_scene = {
    .name = "trainer",
    .about = "An organ is sliced, peeled, drilled, dropped and made whole again, in contact with tools.",
    .cells = 16,
    .small_cells = 6,
    .frames = 60 * SECONDS,
    .small_frames = 20 * SECONDS,
    .least_frames = 20 * SECONDS};

/* The scene has been opened by trainer_scene; its hooks may have been set. */
static inline void trainer_begin(scene *s, trainer *on) {
    gxio_surface surfaces[MATERIALS];
    gx_contact_desc contact;
    int m;
    memset(on, 0, sizeof *on);
    memset(&contact, 0, sizeof contact);
    on->rate = s->small ? 20 : 60;
    organ_surfaces(s, surfaces);
    s->step.dt = 1.0 / on->rate;
    s->step.mass_damping = 1.0;
    s->body_desc.affine_below = 1.0;
    organ_make(s, surfaces, s->cells);
    for (m = 0; m < MATERIALS; m++) gxio_surface_release(&surfaces[m]);
    scene_look(s);
    trainer_hold(s, on);
    organ_measure(s, UINT32_MAX, on->whole);
    on->size = trainer_mean_size(s);
    trainer_call_witnesses(s, on);
    scene_settle(s, 1e-6);
    contact.friction = 0.3;
    scene_must(s, gx_body_contact(s->body, &contact, &s->failure), "contact");
    on->blade = scene_make_blade(s, NULL);
    for (m = 0; m < PHASES; m++) on->seconds[m] = (double *)scene_array(s, s->frames, sizeof(double));
    s->step.colliders = on->tools;
    s->step.collider_loads = on->loads;
    s->step.collider_count = TOOLS;
    s->step.region_poses = on->poses;
}

static inline int trainer_compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static inline void trainer_say_times(scene *s, trainer *on) {
    static const char *const names[PHASES] = {"blade and cuts", "model and contact", "solver", "skin", "frame"};
    const size_t n = s->frame;
    int i;
    for (i = 0; i < PHASES; i++) {
        double *seconds = on->seconds[i];
        qsort(seconds, n, sizeof *seconds, trainer_compare);
        scene_say(s, "%s, ms: median %.1f, 95 %% below %.1f, 99 %% below %.1f, worst %.1f%s", names[i],
                  1e3 * seconds[n / 2], 1e3 * seconds[n * 95 / 100], 1e3 * seconds[n * 99 / 100], 1e3 * seconds[n - 1],
                  i == PHASE_FRAME ? " (a frame has 16.7)" : "");
    }
    scene_say(s, "states at the ends of rounds: %08lx%08lx", (unsigned long)(on->hash >> 32),
              (unsigned long)(on->hash & 0xffffffffu));
}

static inline void trainer_report(scene *s, trainer *on) {
    scene_check(s, on->counts_wrong == 0 && on->bridged == 0 && on->split == 0,
                "of %lu places judged, those in a piece that they were cut off from: %lu (0), in another piece than "
                "their own: %lu (0); counts of pieces that are wrong: %lu (0)",
                (unsigned long)on->judged, (unsigned long)on->bridged, (unsigned long)on->split,
                (unsigned long)on->counts_wrong);
    scene_check(s, on->judged > 4 * on->doubtful, "places too near to a stroke to be judged: %lu (less than a fifth)",
                (unsigned long)on->doubtful);
    scene_check(s, on->tumour <= 1e-12, "the tumour's piece against the tumour: %.1e off (at most 1e-12)", on->tumour);
    scene_check(s, on->drift <= 1e-12, "volume with what was drilled, by rounds: %.1e off (at most 1e-12)", on->drift);
    scene_check(s, on->twins_wrong == 0, "loaded and cloned bodies that went on otherwise: %lu of %lu (0)",
                (unsigned long)on->twins_wrong, (unsigned long)on->twins);
    scene_check(s, on->harmed == 0 && on->not_refused == 0,
                "of %lu calls that ran out of memory and %lu hostile poses of tools that were refused by name, those "
                "that harmed the body: %lu (0)",
                (unsigned long)on->ran_out, (unsigned long)on->refused, (unsigned long)on->harmed);
    scene_check(s, on->undone_wrong == 0, "bodies that were not as before when undone: %lu (0)",
                (unsigned long)on->undone_wrong);
    scene_check(s, on->farthest < 1.0 && on->fastest < 6.0,
                "farthest copy: %.2f m from its place at rest (less than 1 m); fastest: %.1f m/s (less than 6)",
                on->farthest, on->fastest);
    scene_check(s, on->rounds == 0 || 2 * on->last_memory <= 3 * on->first_memory,
                "memory: %.1f MB at its peak, %.1f after a round (at most 1.5 times)", 1e-6 * (double)on->last_memory,
                1e-6 * (double)on->first_memory);
    scene_say(s, "specks that strokes left, below 1e-6 of the body: %lu; deepest overlap: %.4f m, %.2f of an element",
              (unsigned long)on->specks, on->deepest, on->deepest / on->size);
    trainer_say_times(s, on);
}

static inline void trainer_end(trainer *on) {
    int i;
    gx_body_destroy(on->mark);
    gx_body_destroy(on->slip);
    gx_body_destroy(on->twin.body);
    for (i = 0; i < PHASES; i++) free(on->seconds[i]);
    free(on->witnesses);
}

#endif /* TRAINER_H */
