/* open.c - the like of the Open Boolean Benchmark's workloads, and what runners of it answer.

       open write FOLDER [--small]            surfaces and FOLDER/NAME.json, a request for each workload; their names on
                                              stdout, a line each
       open read FOLDER NAME RUNNER SECONDS   a row of CSV: what RUNNER answered in FOLDER/RUNNER/NAME.json; SECONDS:
   how long its process took, or a word if it gave no answer

   `make bench-open` runs all of it (bench/open.sh). Workloads:

       cubes    a grid of unit cubes united one by one, then taken away one by one: nothing is left
       turned   the same, turned, and each cube moved a little: faces nearly meet. As many are taken away
       csg      bumpy spheres, united and taken away in turn
       terrain  a block with a rough top less tools along winding paths, one by one
       dome     a dome less capsules that stick in it, one by one
       spheres  a sphere less a moved copy
       bumpy    the same with waves on the sphere
       crossing a surface that crosses itself less a moved copy

   The volume beside which answers stand is computed here, from the request alone, by parallel rays: where a ray crosses
   which surface. It is right to some parts in ten thousand. */
#define _POSIX_C_SOURCE 200809L
#include "../examples/gxio.h"
#include "../examples/gxjson.h"
#include "splitmix.h"

enum { RAYS = 256, ROOM = 4096 };

static const double tau = 6.283185307179586;

static void stop(const char *what, const char *why) {
    fprintf(stderr, "open: %s: %s\n", what, why);
    exit(1);
}

static void *need(void *memory) {
    if (!memory) stop("memory", "there is none");
    return memory;
}

/* ----- surfaces */

static double uniform(uint64_t *state, double low, double high) {
    return low + (high - low) * (double)(splitmix64(state) >> 11) * 0x1p-53;
}

static void vertex(gxio_surface *s, const double x[3]) {
    if (!gxio_add_vertex(s, x[0], x[1], x[2])) stop("memory", "there is none");
}

static void triangle(gxio_surface *s, size_t a, size_t b, size_t c) {
    if (!gxio_add_triangle(s, (uint32_t)a, (uint32_t)b, (uint32_t)c, 0)) stop("memory", "there is none");
}

/* A rotation by an angle around a random axis */
static void random_rotation(uint64_t *state, double turn[3][3]) {
    double a[3], length = 0;
    const double angle = uniform(state, 0, tau);
    int i, k;
    for (k = 0; k < 3; k++) {
        a[k] = uniform(state, -1, 1);
        length += a[k] * a[k];
    }
    for (k = 0; k < 3; k++) a[k] /= sqrt(length);
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) {
            const double cross = i == k ? 0 : (k - i + 3) % 3 == 1 ? -a[3 - i - k] : a[3 - i - k];
            turn[i][k] = (i == k ? cos(angle) : 0) + (1 - cos(angle)) * a[i] * a[k] + sin(angle) * cross;
        }
}

static void move(gxio_surface *s, const double turn[3][3], const double by[3]) {
    size_t v;
    int i, k;
    for (v = 0; v < s->vertex_count; v++) {
        double x[3];
        for (i = 0; i < 3; i++)
            for (k = 0, x[i] = by[i]; k < 3; k++) x[i] += turn[i][k] * s->vertices[3 * v + (size_t)k];
        memcpy(s->vertices + 3 * v, x, sizeof x);
    }
}

static const double as_it_is[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static gxio_surface make_box(const double low[3], const double high[3]) {
    static const uint32_t faces[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    gxio_surface s;
    int i, k;
    memset(&s, 0, sizeof s);
    for (i = 0; i < 8; i++) {
        double x[3];
        for (k = 0; k < 3; k++) x[k] = i >> k & 1 ? high[k] : low[k];
        vertex(&s, x);
    }
    for (i = 0; i < 36; i += 3) triangle(&s, faces[i], faces[i + 1], faces[i + 2]);
    return s;
}

/* Rings of `around` vertices about the z axis, from the lower pole to the upper: a ring for each of rings - 1 heights.
   place gives a point by its angle along (0 at the lower pole, pi at the upper) and about the axis. */
typedef void place_at(const void *user, double along, double about, double x[3]);

static gxio_surface make_round(size_t rings, size_t around, place_at *place, const void *user) {
    gxio_surface s;
    size_t r, a;
    double x[3];
    memset(&s, 0, sizeof s);
    place(user, 0, 0, x);
    vertex(&s, x);
    for (r = 1; r < rings; r++)
        for (a = 0; a < around; a++) {
            place(user, 0.5 * tau * (double)r / (double)rings, tau * (double)a / (double)around, x);
            vertex(&s, x);
        }
    place(user, 0.5 * tau, 0, x);
    vertex(&s, x);
    for (a = 0; a < around; a++) {
        const size_t next = (a + 1) % around, last = 1 + (rings - 2) * around;
        triangle(&s, 0, 1 + next, 1 + a);
        triangle(&s, s.vertex_count - 1, last + a, last + next);
        for (r = 1; r + 1 < rings; r++) {
            const size_t low = 1 + (r - 1) * around, high = low + around;
            triangle(&s, low + a, low + next, high + next);
            triangle(&s, low + a, high + next, high + a);
        }
    }
    return s;
}

typedef struct round_shape {
    double radius, length, bump, waves;
    int crosses; /* goes twice around the axis, with two radii: it crosses itself */
} round_shape;

/* A ball with bumps, or (length > 0) a capsule along z */
static void place_round(const void *user, double along, double about, double x[3]) {
    const round_shape *shape = (const round_shape *)user;
    double r =
        shape->radius * (1 + shape->bump * sin(shape->waves * about) * pow(sin(along), 2) * cos(shape->waves * along));
    if (shape->crosses) r *= 1 + 0.2 * sin(along) * cos(about), about *= 2;
    x[0] = r * sin(along) * cos(about);
    x[1] = r * sin(along) * sin(about);
    x[2] = -r * cos(along) + (along > 0.25 * tau ? 0.5 : -0.5) * shape->length;
}

static gxio_surface make_ball(size_t rings, double radius, double length, double bump, double waves) {
    round_shape shape;
    shape.radius = radius;
    shape.length = length;
    shape.bump = bump;
    shape.waves = waves;
    shape.crosses = 0;
    return make_round(rings, 2 * rings, place_round, &shape);
}

/* A block of side 1 and height about 0.3, with a rough top of n x n squares */
static gxio_surface make_terrain(size_t n, uint64_t *state) {
    gxio_surface s;
    double phase[8][3];
    size_t i, j, k;
    memset(&s, 0, sizeof s);
    for (k = 0; k < 8; k++) {
        phase[k][0] = uniform(state, -3, 3) * (double)(k + 1);
        phase[k][1] = uniform(state, -3, 3) * (double)(k + 1);
        phase[k][2] = uniform(state, 0, tau);
    }
    for (k = 0; k < 2; k++) /* the top, then the bottom */
        for (j = 0; j <= n; j++)
            for (i = 0; i <= n; i++) {
                double x[3];
                size_t w;
                x[0] = (double)i / (double)n;
                x[1] = (double)j / (double)n;
                x[2] = k == 0 ? 0.3 : 0;
                for (w = 0; w < 8 && k == 0; w++)
                    x[2] += 0.03 / (double)(w + 1) * sin(tau * (phase[w][0] * x[0] + phase[w][1] * x[1]) + phase[w][2]);
                vertex(&s, x);
            }
    for (j = 0; j < n; j++)
        for (i = 0; i < n; i++) {
            const size_t a = i + (n + 1) * j, below = (n + 1) * (n + 1);
            triangle(&s, a, a + 1, a + n + 2);
            triangle(&s, a, a + n + 2, a + n + 1);
            triangle(&s, a + below, a + n + 2 + below, a + 1 + below);
            triangle(&s, a + below, a + n + 1 + below, a + n + 2 + below);
        }
    for (k = 0; k < 4 * n; k++) { /* walls along the outline */
        const size_t side = k / n, along = k % n, below = (n + 1) * (n + 1);
        size_t a, b;
        switch (side) {
        case 0: a = along, b = along + 1; break;
        case 1: a = n + (n + 1) * along, b = a + n + 1; break;
        case 2: a = n * (n + 1) + n - along, b = a - 1; break;
        default: a = (n + 1) * (n - along), b = a - (n + 1);
        }
        triangle(&s, b, a, a + below);
        triangle(&s, b, a + below, b + below);
    }
    return s;
}

/* ----- workloads */

typedef struct workload {
    const char *folder, *name;
    FILE *request;
    size_t count; /* operations so far */
} workload;

static void begin(workload *w, const char *folder, const char *name) {
    char path[ROOM];
    w->folder = folder;
    w->name = name;
    w->count = 0;
    snprintf(path, sizeof path, "%s/%s.json", folder, name);
    w->request = fopen(path, "w");
    if (!w->request) stop(path, "cannot be written");
    fprintf(w->request, "{\"kind\": \"boolean-benchmark\", \"version\": 1, \"id\": \"%s\", \"runs\": [\n", name);
    fprintf(w->request, "{\"case_id\": \"%s\", \"out_dir\": \"%s/out\", \"operations\": [\n", name, folder);
}

static void end(workload *w) {
    fprintf(w->request, "]}]}\n");
    if (fclose(w->request) != 0) stop(w->name, "cannot be written");
    printf("%s\n", w->name);
}

/* Writes a surface and loads it. Returns its solid. */
static size_t load(workload *w, gxio_surface s) {
    char path[ROOM];
    gxio_shell shell;
    gxio_error error;
    memset(&shell, 0, sizeof shell);
    shell.vertices = s.vertices;
    shell.vertex_count = s.vertex_count;
    shell.triangles = s.triangles;
    shell.triangle_count = s.triangle_count;
    snprintf(path, sizeof path, "%s/%s_%lu.off", w->folder, w->name, (unsigned long)w->count);
    if (!gxio_write_surface(path, &shell, &error)) stop(path, "cannot be written");
    gxio_surface_release(&s);
    fprintf(w->request, "%s{\"op\": \"load-mesh\", \"path\": \"%s\"}", w->count ? ",\n" : "", path);
    return w->count++;
}

static size_t combine(workload *w, const char *operation, size_t a, size_t b) {
    fprintf(w->request, ",\n{\"op\": \"boolean-%s\", \"args\": [%lu, %lu]}", operation, (unsigned long)a,
            (unsigned long)b);
    return w->count++;
}

static void write_cubes(const char *folder, const char *name, size_t n, int turned) {
    workload w;
    uint64_t state = 7;
    double turn[3][3], by[3] = {0, 0, 0};
    size_t i, whole = 0, *cubes = (size_t *)need(malloc(n * n * n * sizeof *cubes));
    begin(&w, folder, name);
    random_rotation(&state, turn);
    for (i = 0; i < n * n * n; i++) {
        double low[3], high[3];
        gxio_surface cube;
        int k;
        low[0] = (double)(i % n), low[1] = (double)(i / n % n), low[2] = (double)(i / n / n);
        for (k = 0; k < 3; k++) high[k] = low[k] + 1;
        cube = make_box(low, high);
        if (turned) {
            for (k = 0; k < 3; k++) by[k] = uniform(&state, -1e-3, 1e-3);
            move(&cube, (const double(*)[3])turn, by);
        }
        cubes[i] = load(&w, cube);
    }
    for (i = 0, whole = cubes[0]; i + 1 < n * n * n; i++) whole = combine(&w, "union", whole, cubes[i + 1]);
    for (i = 0; i < n * n * n; i++) whole = combine(&w, "difference", whole, cubes[i]);
    free(cubes);
    end(&w);
}

static void write_csg(const char *folder, const char *name, size_t count, size_t rings) {
    workload w;
    uint64_t state = 11;
    size_t i, whole = 0;
    begin(&w, folder, name);
    for (i = 0; i <= count; i++) {
        gxio_surface ball = make_ball(rings, uniform(&state, 0.3, 0.6), 0, 0.2, 5);
        double turn[3][3], by[3];
        size_t next;
        int k;
        random_rotation(&state, turn);
        for (k = 0; k < 3; k++) by[k] = uniform(&state, -1, 1);
        move(&ball, (const double(*)[3])turn, by);
        next = load(&w, ball);
        whole = i == 0 ? next : combine(&w, i % 3 == 2 ? "difference" : "union", whole, next);
    }
    end(&w);
}

static void write_terrain(const char *folder, const char *name, size_t count, size_t squares) {
    workload w;
    uint64_t state = 13;
    size_t i, whole;
    double x = 0.5, y = 0.5, heading = 0;
    begin(&w, folder, name);
    whole = load(&w, make_terrain(squares, &state));
    for (i = 0; i < count; i++) {
        gxio_surface tool = make_ball(12, 0.025, 0.06, 0, 0);
        double turn[3][3], by[3];
        heading += uniform(&state, -0.5, 0.5);
        if (x < 0.1 || x > 0.9 || y < 0.1 || y > 0.9) heading = atan2(0.5 - y, 0.5 - x) + uniform(&state, -0.3, 0.3);
        x += 0.02 * cos(heading);
        y += 0.02 * sin(heading);
        random_rotation(&state, turn);
        by[0] = x, by[1] = y, by[2] = 0.3;
        move(&tool, (const double(*)[3])turn, by);
        whole = combine(&w, "difference", whole, load(&w, tool));
    }
    end(&w);
}

static void write_dome(const char *folder, const char *name, size_t count, size_t rings) {
    workload w;
    uint64_t state = 17;
    double by[3] = {0, 0, 0}, low[3] = {-2, -2, -2}, high[3] = {2, 2, 0};
    size_t i, whole;
    begin(&w, folder, name);
    whole = load(&w, make_ball(rings, 1, 0, 0, 0));
    whole = combine(&w, "difference", whole, load(&w, make_box(low, high)));
    for (i = 0; i < count; i++) {
        gxio_surface capsule = make_ball(10, 0.03, 0.2, 0, 0);
        double turn[3][3], up = uniform(&state, 0.05, 1), about = uniform(&state, 0, tau);
        random_rotation(&state, turn);
        by[0] = sqrt(1 - up * up) * cos(about), by[1] = sqrt(1 - up * up) * sin(about), by[2] = up;
        move(&capsule, (const double(*)[3])turn, by);
        whole = combine(&w, "difference", whole, load(&w, capsule));
    }
    end(&w);
}

static void write_spheres(const char *folder, const char *name, size_t rings, double bump, int crosses) {
    workload w;
    round_shape shape;
    gxio_surface ball;
    const double by[3] = {0.5, 0.013, 0.007};
    size_t whole;
    shape.radius = 1;
    shape.length = 0;
    shape.bump = bump;
    shape.waves = 7;
    shape.crosses = crosses;
    begin(&w, folder, name);
    ball = make_round(rings, 2 * rings, place_round, &shape);
    whole = load(&w, ball);
    ball = make_round(rings, 2 * rings, place_round, &shape);
    move(&ball, as_it_is, by);
    combine(&w, "difference", whole, load(&w, ball));
    end(&w);
}

static void write_all(const char *folder, int small) {
    write_cubes(folder, "cubes", small ? 3 : 10, 0);
    write_cubes(folder, "turned", small ? 3 : 10, 1);
    write_csg(folder, "csg", small ? 6 : 60, small ? 8 : 32);
    write_terrain(folder, "terrain", small ? 8 : 224, small ? 16 : 128);
    write_dome(folder, "dome_100", small ? 5 : 100, small ? 16 : 64);
    write_spheres(folder, "spheres_8k", small ? 8 : 45, 0, 0);
    write_spheres(folder, "crossing_8k", small ? 8 : 45, 0, 1);
    if (small) return;
    write_dome(folder, "dome_250", 250, 64);
    write_dome(folder, "dome_1000", 1000, 64);
    write_spheres(folder, "spheres_500", 11, 0, 0);
    write_spheres(folder, "spheres_131k", 181, 0, 0);
    write_spheres(folder, "bumpy_131k", 181, 0.1, 0);
    write_spheres(folder, "crossing_131k", 181, 0, 1);
    write_spheres(folder, "spheres_524k", 362, 0, 0);
    write_spheres(folder, "spheres_2m", 708, 0, 0);
}

/* ----- volumes */

/* Where ray `ray` crosses solid `solid`; turn: how the winding number changes going up */
typedef struct crossing {
    uint32_t ray, solid;
    double z;
    int turn;
} crossing;

typedef struct crossings {
    crossing *items;
    size_t count, room;
} crossings;

static double minimum(double a, double b) { return a < b ? a : b; }
static double maximum(double a, double b) { return a > b ? a : b; }

static void add_crossing(crossings *c, size_t ray, size_t solid, double z, int turn) {
    if (c->count == c->room) {
        c->room = c->room ? 2 * c->room : 1024;
        c->items = (crossing *)need(realloc(c->items, c->room * sizeof *c->items));
    }
    c->items[c->count].ray = (uint32_t)ray;
    c->items[c->count].solid = (uint32_t)solid;
    c->items[c->count].z = z;
    c->items[c->count++].turn = turn;
}

/* Rays stand at odd places, so that none hits an edge. */
static double ray_place(double low, double step, size_t i, int axis) {
    return low + step * ((double)i + (axis == 0 ? 0.4837261 : 0.5219473));
}

static void cross_triangle(crossings *c, size_t solid, const double *p[3], const double low[2], const double step[2]) {
    size_t first[2], last[2], i, j;
    int k;
    for (k = 0; k < 2; k++) {
        const double a = (minimum(minimum(p[0][k], p[1][k]), p[2][k]) - low[k]) / step[k] - 1;
        const double b = (maximum(maximum(p[0][k], p[1][k]), p[2][k]) - low[k]) / step[k] + 1;
        first[k] = a > 0 ? (size_t)a : 0;
        last[k] = b < RAYS ? b > 0 ? (size_t)b : 0 : RAYS;
    }
    for (j = first[1]; j < last[1]; j++)
        for (i = first[0]; i < last[0]; i++) {
            const double x = ray_place(low[0], step[0], i, 0), y = ray_place(low[1], step[1], j, 1);
            double share[3], sum = 0, z = 0;
            for (k = 0; k < 3; k++) {
                const double *u = p[(k + 1) % 3], *v = p[(k + 2) % 3];
                /* the same bits whichever triangle has the edge */
                const int swapped = u[0] > v[0] || (u[0] == v[0] && u[1] > v[1]);
                const double *a = swapped ? v : u, *b = swapped ? u : v;
                const double area = (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y);
                share[k] = swapped ? -area : area;
                sum += share[k];
                z += share[k] * p[k][2];
            }
            if ((share[0] > 0 && share[1] > 0 && share[2] > 0) || (share[0] < 0 && share[1] < 0 && share[2] < 0))
                add_crossing(c, i + RAYS * j, solid, z / sum, sum < 0 ? 1 : -1);
        }
}

static int compare_crossings(const void *a, const void *b) {
    const crossing *p = (const crossing *)a, *q = (const crossing *)b;
    if (p->ray != q->ray) return p->ray < q->ray ? -1 : 1;
    return (p->z > q->z) - (p->z < q->z);
}

typedef struct request {
    gxjson json;
    size_t count;
    int *operation; /* 0 load, 1 union, 2 intersection, 3 difference */
    size_t (*args)[2];
    gxio_surface *surfaces;
} request;

static void read_request(request *r, const char *path) {
    gxio_error error;
    size_t list, at;
    memset(r, 0, sizeof *r);
    if (!gxjson_read(&r->json, path, &error)) stop("request", error.text);
    list = gxjson_find(&r->json, gxjson_find(&r->json, 0, "runs") + 1, "operations");
    for (at = list + 1; at < r->json.values[list].next; at = r->json.values[at].next) r->count++;
    r->operation = (int *)need(calloc(r->count, sizeof *r->operation));
    r->args = (size_t(*)[2])need(calloc(r->count, sizeof *r->args));
    r->surfaces = (gxio_surface *)need(calloc(r->count, sizeof *r->surfaces));
    r->count = 0;
    for (at = list + 1; at < r->json.values[list].next; at = r->json.values[at].next) {
        const size_t i = r->count++, op = gxjson_find(&r->json, at, "op"), args = gxjson_find(&r->json, at, "args");
        r->operation[i] = gxjson_equals(&r->json, op, "load-mesh")            ? 0
                        : gxjson_equals(&r->json, op, "boolean-union")        ? 1
                        : gxjson_equals(&r->json, op, "boolean-intersection") ? 2
                                                                              : 3;
        if (r->operation[i] == 0) {
            char *file = (char *)need(gxjson_text(&r->json, gxjson_find(&r->json, at, "path")));
            if (!gxio_surface_read(file, &r->surfaces[i], &error)) stop("surface", error.text);
            free(file);
        } else if (!gxjson_index(&r->json, args + 1, i, &r->args[i][0]) ||
                   !gxjson_index(&r->json, args + 2, i, &r->args[i][1]))
            stop(path, "an operation has not two solids before it");
    }
}

/* The solid that the last operation makes: its volume by rays */
static double volume_by_rays(const request *r) {
    crossings c;
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300}, step[2], sum = 0;
    int *winding = (int *)need(calloc(r->count, sizeof *winding));
    char *inside = (char *)need(calloc(r->count, 1));
    size_t i, t, at;
    int k;
    memset(&c, 0, sizeof c);
    for (i = 0; i < r->count; i++)
        for (t = 0; t < 3 * r->surfaces[i].vertex_count; t++) {
            low[t % 3] = minimum(low[t % 3], r->surfaces[i].vertices[t]);
            high[t % 3] = maximum(high[t % 3], r->surfaces[i].vertices[t]);
        }
    for (k = 0; k < 2; k++) step[k] = (high[k] - low[k]) / RAYS;
    for (i = 0; i < r->count; i++)
        for (t = 0; t < r->surfaces[i].triangle_count; t++) {
            const double *p[3];
            for (k = 0; k < 3; k++)
                p[k] = r->surfaces[i].vertices + 3 * (size_t)r->surfaces[i].triangles[3 * t + (size_t)k];
            cross_triangle(&c, i, p, low, step);
        }
    qsort(c.items, c.count, sizeof *c.items, compare_crossings);
    for (at = 0; at + 1 < c.count; at++) {
        winding[c.items[at].solid] += c.items[at].turn;
        if (c.items[at].ray != c.items[at + 1].ray) {
            memset(winding, 0, r->count * sizeof *winding);
            continue;
        }
        if (!(c.items[at + 1].z > c.items[at].z)) continue;
        for (i = 0; i < r->count; i++) {
            const size_t a = r->args[i][0], b = r->args[i][1];
            switch (r->operation[i]) {
            case 0: inside[i] = winding[i] != 0; break;
            case 1: inside[i] = inside[a] || inside[b]; break;
            case 2: inside[i] = inside[a] && inside[b]; break;
            default: inside[i] = inside[a] && !inside[b];
            }
        }
        if (inside[r->count - 1]) sum += (c.items[at + 1].z - c.items[at].z) * step[0] * step[1];
    }
    free(winding);
    free(inside);
    free(c.items);
    return sum;
}

/* ----- answers */

typedef struct measures {
    double volume, area;
    size_t triangles;
    long euler;
} measures;

static int compare_edges(const void *a, const void *b) {
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

/* Of a surface as it is written: vertices that triangles have, less edges, plus triangles */
static measures measure(const gxio_surface *s) {
    measures m;
    uint64_t *edges = (uint64_t *)need(malloc((3 * s->triangle_count + 1) * sizeof *edges));
    char *used = (char *)need(calloc(s->vertex_count + 1, 1));
    size_t t, count = 0;
    int k;
    memset(&m, 0, sizeof m);
    m.triangles = s->triangle_count;
    for (t = 0; t < s->triangle_count; t++) {
        const uint32_t *n = s->triangles + 3 * t;
        const double *p = s->vertices + 3 * (size_t)n[0], *q = s->vertices + 3 * (size_t)n[1],
                     *r = s->vertices + 3 * (size_t)n[2];
        double u[3], v[3], c[3];
        for (k = 0; k < 3; k++) {
            const uint32_t a = n[k], b = n[(k + 1) % 3];
            u[k] = q[k] - p[k];
            v[k] = r[k] - p[k];
            edges[count++] = (uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a);
            used[a] = 1;
        }
        for (k = 0; k < 3; k++) c[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        m.area += 0.5 * sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        m.volume += (p[0] * c[0] + p[1] * c[1] + p[2] * c[2]) / 6;
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    m.euler = (long)s->triangle_count;
    for (t = 0; t < count; t++) m.euler -= t == 0 || edges[t] != edges[t - 1];
    for (t = 0; t < s->vertex_count; t++) m.euler += used[t];
    free(edges);
    free(used);
    return m;
}

static double number_of(const gxjson *json, size_t object, const char *key) {
    const size_t value = gxjson_find(json, object, key);
    return gxjson_is(json, value, GXJSON_NUMBER) ? strtod(json->values[value].text, NULL) : 0;
}

static void read_answer(const char *folder, const char *name, const char *runner, const char *seconds) {
    char path[ROOM], *status = NULL, *file = NULL;
    request asked;
    gxjson json;
    gxio_error error;
    gxio_surface surface;
    measures m;
    double loading = 0, operating = 0, output = 0, volume;
    size_t i, run, list, at, triangles = 0, count = 0;
    memset(&m, 0, sizeof m);
    memset(&surface, 0, sizeof surface);
    snprintf(path, sizeof path, "%s/%s.json", folder, name);
    read_request(&asked, path);
    volume = volume_by_rays(&asked);
    for (i = 0; i < asked.count; i++) triangles += asked.surfaces[i].triangle_count;
    snprintf(path, sizeof path, "%s/%s/%s.json", folder, runner, name);
    if (strtod(seconds, NULL) == 0 || !gxjson_read(&json, path, &error)) {
        printf("%s,%s,%lu,%lu,%s,,,,,,,%.9g\n", name, runner, (unsigned long)asked.count, (unsigned long)triangles,
               strtod(seconds, NULL) == 0 ? seconds : "crash", volume);
        return;
    }
    run = gxjson_find(&json, 0, "runs") + 1;
    list = gxjson_find(&json, run, "ops");
    for (at = list + 1; at < json.values[list].next; at = json.values[at].next, count++) {
        loading += number_of(&json, at, "import_ms");
        operating += number_of(&json, at, "operation_ms");
        output = number_of(&json, at, "export_ms");
        free(file);
        file = (char *)need(gxjson_text(&json, gxjson_find(&json, at, "file")));
    }
    status = (char *)need(gxjson_text(&json, gxjson_find(&json, run, "status")));
    if (file && strcmp(status, "success") == 0) {
        if (gxio_surface_read(file, &surface, &error))
            m = measure(&surface);
        else
            snprintf(status, strlen(status) + 1, "file");
    }
    printf("%s,%s,%lu,%lu,%s,%lu,%.3f,%.3f,%lu,%ld,%.12g,%.9g\n", name, runner, (unsigned long)asked.count,
           (unsigned long)triangles, status, (unsigned long)count, loading + operating, output,
           (unsigned long)m.triangles, m.euler, m.volume, volume);
}

int main(int argc, char **argv) {
    if (argc >= 3 && strcmp(argv[1], "write") == 0)
        write_all(argv[2], argc > 3 && strcmp(argv[3], "--small") == 0);
    else if (argc == 6 && strcmp(argv[1], "read") == 0)
        read_answer(argv[2], argv[3], argv[4], argv[5]);
    else {
        fprintf(stderr, "usage: open write FOLDER [--small] | open read FOLDER NAME RUNNER SECONDS\n");
        return 2;
    }
    return 0;
}
