/* gxcut: cuts a tetrahedral mesh with triangle surfaces, steps it in time, writes frames and a report.

   gxcut MESH [--sheet CUT]... [--solid CUT]... [options]; `gxcut --help` says the rest.
   Exit codes: 0 done; 1 a cut or a step failed; 2 usage error, or a file that can't be read or written.
   On 1 and 2 one line on stderr says what, where and why.

   contents
     >>settings    the command line
     >>input       mesh, cuts, blade, body
     >>cut         all surfaces in one call; view and skin
     >>frames      their files, the progress bar, where a run ends early
     >>blade       the blade that cuts while the body steps
     >>run         steps, frame by frame
     >>depth       how far pieces are in each other
     >>report      summary and JSON */
#include "gxio.h"

#ifndef GXFEM_LINKED /* make examples compiles the library once for all */
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "gxfailure.h"
#include "gxoverlap.h"

#ifdef _WIN32
#include <io.h>
#define STDERR_IS_TERMINAL (_isatty(2) != 0)
#else
#include <unistd.h>
#define STDERR_IS_TERMINAL (isatty(2) != 0)
#endif

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_MISUSED = 2 };

/* -------------------------------------------------------------------------------------------- >>settings */

/* What lies inside of a surface is of another material. */
typedef struct inclusion {
    char *cut; /* as given, without the numbers behind it; owned */
    gx_material material;
    gxio_surface surface;
} inclusion;

typedef struct settings {
    const char *mesh, *shape, *blade, *out, *format, *report;
    const char **cuts; /* cut_count, as given */
    uint32_t *kinds;   /* cut_count, GX_SURFACE_ */
    size_t cut_count;
    gx_region *regions; /* region_count */
    size_t region_count;
    inclusion *inclusions; /* inclusion_count: material i + 1 */
    size_t inclusion_count;
    double thickness;   /* m; 0: sheets stay sheets */
    gx_blade_desc edge; /* of the blade */
    double dt, young, poisson, density, affine, gravity[3], stretch[3];
    double friction, ground, sleep; /* of contact: coefficient, m, m/s */
    gx_collider *colliders;         /* collider_count; room for one more */
    size_t collider_count;
    uint32_t frames, newton, cut_at, cells;
    int release, rests; /* --release, --static */
    int contact, grounded, quiet, help;
} settings;

/* What the blade did */
typedef struct strokes {
    size_t moves, triangles;
    size_t layers;         /* most at once */
    size_t divided;        /* elements that got more cells, summed over the blade's cuts */
    double deviation;      /* the largest, m */
    double seconds;        /* in moves and lifts */
    double min_link_ratio; /* the smallest */
    double seconds_arrangement, seconds_enrichment, seconds_integrals;
} strokes;

typedef struct run {
    settings set;
    gxio_mesh mesh;
    gxio_surface shape;
    gxio_surface *cuts; /* cut_count */
    gxio_blade edges;
    gx_body *body;
    gx_blade *blade; /* the body's; NULL: none */
    strokes strokes;
    uint32_t *divided_at; /* element_count: number of the last cut of the blade that gave the element more cells */
    uint32_t blade_cuts;
    gx_view view;
    gx_skin skin;
    double *skin_positions; /* skin.vertex_count x 3 */
    float *skin_normals;    /* the same */
    gxio_page page;         /* of --format html */
    int has_page, has_mesh; /* the page is open; it has the triangles of the skin */
    gx_cut_report cut;
    int has_cut;
    gx_step_report stepped; /* of the last step */
    uint32_t frames_written;
    int bar; /* a progress bar stands on stderr */
    double seconds_start, seconds_newton;
    gxio_error error;
} run;

/* What an option takes. Those behind the flag, which takes nothing, may be given more than once. */
enum {
    TAKES_TEXT,
    TAKES_NUMBER,
    TAKES_COUNT,
    TAKES_VECTOR,
    TAKES_NOTHING,
    TAKES_SHEET,
    TAKES_SOLID,
    TAKES_KEEP,
    TAKES_MATERIAL,
    TAKES_REGION,
    TAKES_COLLIDER
};

typedef struct option {
    const char *name;
    int takes;
    void *target; /* const char *, double, uint32_t, double[3] or int of the settings */
    int seen;
} option;

static const char usage[] =
    "usage: gxcut MESH [--sheet CUT]... [--solid CUT]... [options]\n"
    "       gxcut --shape CUT [--cells N] [--sheet CUT]... [options]\n"
    "\n"
    "Cuts a tetrahedral mesh exactly, steps it in time and writes a surface per frame.\n"
    "\n"
    "MESH   FILE.mesh                Medit, ASCII\n"
    "       FILE.msh                 Gmsh 2.2 or 4.1, ASCII\n"
    "       FILE.vtk                 legacy VTK, unstructured grid, ASCII\n"
    "       FILE.node, FILE.ele      TetGen; either name, or FILE alone\n"
    "       cube5                    unit cube of 5 tetrahedra\n"
    "       grid:NX,NY,NZ[,5|6]      unit cubes of 5 (default) or 6 tetrahedra\n"
    "       tet                      corners at the origin and at 1 on each axis\n"
    "       NAME[:SPACING]           octopus, bunny, armadillo, objects (a plate with things on it), with edges of "
    "about\n"
    "                                SPACING; default and largest: 0.0188 0.05, 0.0085 0.02, 3.9 10, 0.058 0.1\n"
    "       ball:RADIUS,SPACING      about the origin; torus:R,r,SPACING: around the z axis\n"
    "CUT    FILE.obj, FILE.off       triangles or polygons\n"
    "       FILE.stl                 ASCII or binary; corners with equal coordinates become one\n"
    "       FILE.vtk                 legacy VTK, polydata, ASCII\n"
    "       plane:PX,PY,PZ,NX,NY,NZ  sheet through P with normal N, across the body\n"
    "       wave:PX,PY,PZ,NX,NY,NZ,AMPLITUDE,WAVELENGTH[,RESOLUTION]\n"
    "                                the same as a sine wave about the plane, which runs along the coordinate\n"
    "                                axis closest to it; RESOLUTION (16) strips per wavelength\n"
    "       box:X0,Y0,Z0,X1,Y1,Z1    closed box\n"
    "\n"
    "  --shape CUT         in place of MESH: the body is all inside of a closed surface, carved out of a grid\n"
    "  --cells N           cubes of the grid along the shape's longest side (16)\n"
    "  --sheet CUT         separates what lies on its two sides\n"
    "  --solid CUT         closed: removes what lies inside\n"
    "  --keep CUT          closed: removes what lies outside\n"
    "  --material CUT,E,NU,RHO\n"
    "                      closed: what lies inside is another material, with Young's modulus, Poisson's ratio and\n"
    "                      density; where several lie, the last one\n"
    "  --release           cuts where materials adjoin\n"
    "  --thickness E       makes each sheet a solid of this thickness, m\n"
    "  --cut-at FRAME      cuts before this frame's step (0)\n"
    "  --blade FILE        a blade that cuts while the body steps, from that frame on. The file has a line for each\n"
    "                      frame: x y z, in space, of each point of the edge at the frame's end, two points or more.\n"
    "                      An empty line lifts the blade, as do the file's end and the last frame; # begins a\n"
    "                      comment\n"
    "  --blade-tolerance M how far a strip of its cut may be off the edge's path, m (0: by the mesh)\n"
    "  --blade-advance M   how far the edge goes before it cuts, m (0: by the mesh)\n"
    "  --blade-inside      the edge may start in the material: a stab\n"
    "  --frames N          steps and frames (60); 0: cut and report only\n"
    "  --static            in place of frames: the balance of forces, as one frame\n"
    "  --dt S              time step, s (0.033)\n"
    "  --newton N          Newton iterations per step (as the library does: 1, more for flung sheets; with\n"
    "                      --static at most, 1000)\n"
    "  --young P           Young's modulus, Pa (1e6)\n"
    "  --poisson X         Poisson's ratio (0.4)\n"
    "  --density D         kg/m3 (1000)\n"
    "  --affine T          material thinner than T elements bends by its thickness (0: none; 1 is a good value)\n"
    "  --gravity X,Y,Z     m/s2 (0,0,-9.81)\n"
    "  --fix 'AXIS<V'      holds the material with x, y or z below V; 'AXIS>V': above\n"
    "  --fix box:X0,Y0,Z0,X1,Y1,Z1, --fix sphere:X,Y,Z,RADIUS\n"
    "                      holds the material inside\n"
    "  --stretch X,Y,Z     starts scaled by these factors about the centre of the bounding box\n";
/* Of contact and files: compilers need not take longer strings than those before. */
static const char usage_rest[] =
    "  --contact           pieces press on each other, from the frame of a cut on\n"
    "  --friction MU       of contact (0)\n"
    "  --ground Z          contact with a plane at this height, m\n"
    "  --collider sphere:X,Y,Z,RADIUS, --collider box:X0,Y0,Z0,X1,Y1,Z1,\n"
    "  --collider capsule:X0,Y0,Z0,X1,Y1,Z1,RADIUS\n"
    "                      contact with a body that is rigid and stays where it is\n"
    "  --sleep SPEED       pieces that are slower for half a second fall asleep, m/s (0: none)\n"
    "  --out PATH          directory of the frames (out); with --format html: the file (out.html)\n"
    "  --format vtu|obj|html\n"
    "                      frames for ParaView with a collection frames.pvd (default), Wavefront, or one page that a\n"
    "                      browser plays, without a network\n"
    "  --report FILE.json  counts, volumes and timings\n"
    "  --quiet             no summary, no progress bar\n"
    "  --help              this text\n";

/* A line "NAME: cause" as the run's error; returns 0. */
static int misused(gxio_error *error, const char *name, const char *cause) {
    return gxio_fail(error, name, 0, "%s", cause);
}

static int parse_count(const char *text, uint32_t *count) {
    int64_t value;
    if (!gxio_parse_integer(text, text + strlen(text), &value) || value < 0 || value > 1000000) return 0;
    *count = (uint32_t)value;
    return 1;
}

/* AXIS<V, AXIS>V, box:X0,Y0,Z0,X1,Y1,Z1, sphere:X,Y,Z,R */
static int parse_region(const char *text, gx_region *region) {
    const char *box = gxio_after(text, "box:"), *sphere = gxio_after(text, "sphere:");
    double v[6];
    if (box) {
        if (gxio_argument_list(box, v, 6, 6) != 6) return 0;
        *region = gx_region_box(v, v + 3);
        return 1;
    }
    if (sphere) {
        if (gxio_argument_list(sphere, v, 4, 4) != 4) return 0;
        *region = gx_region_sphere(v, v[3]);
        return 1;
    }
    if (text[0] < 'x' || text[0] > 'z' || (text[1] != '<' && text[1] != '>')) return 0;
    if (!gxio_argument_number(text + 2, v)) return 0;
    *region = gx_region_half_space((uint32_t)(text[0] - 'x'), text[1] == '<' ? -1 : 1, v[0]);
    return 1;
}

/* A collider that stays where it is. axis: what its z axis is */
static void place_collider(gx_collider *collider, const double center[3], const double axis[3]) {
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double z[3], x[3] = {0, 0, 0}, along;
    int k, least = 0;
    for (k = 0; k < 3; k++) z[k] = axis[k] / length;
    for (k = 1; k < 3; k++)
        if (fabs(z[k]) < fabs(z[least])) least = k;
    for (k = 0; k < 3; k++) x[k] = (k == least) - z[least] * z[k]; /* across the axis */
    along = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        collider->pose[4 * k] = x[k] / along;
        collider->pose[4 * k + 1] = (z[i] * x[j] - z[j] * x[i]) / along;
        collider->pose[4 * k + 2] = z[k];
        collider->pose[4 * k + 3] = center[k];
    }
}

/* sphere:X,Y,Z,R, box:X0,Y0,Z0,X1,Y1,Z1, capsule:X0,Y0,Z0,X1,Y1,Z1,R */
static int parse_collider(const char *text, gx_collider *collider) {
    static const double up[3] = {0, 0, 1};
    const char *sphere = gxio_after(text, "sphere:"), *box = gxio_after(text, "box:"),
               *capsule = gxio_after(text, "capsule:");
    double v[7] = {0, 0, 0, 0, 0, 0, 0}, center[3], way[3], square = 0;
    int k;
    memset(collider, 0, sizeof *collider);
    if (sphere) {
        if (gxio_argument_list(sphere, v, 4, 4) != 4 || !(v[3] > 0)) return 0;
        collider->kind = GX_COLLIDER_SPHERE;
        collider->size[0] = v[3];
        place_collider(collider, v, up);
        return 1;
    }
    if (!box && !capsule) return 0;
    if (box ? gxio_argument_list(box, v, 6, 6) != 6 : gxio_argument_list(capsule, v, 7, 7) != 7 || !(v[6] > 0))
        return 0;
    for (k = 0; k < 3; k++) {
        center[k] = 0.5 * (v[k] + v[3 + k]);
        way[k] = v[3 + k] - v[k];
        square += way[k] * way[k];
        if (box && !(way[k] > 0)) return 0;
        collider->size[k] = 0.5 * way[k];
    }
    collider->kind = box ? GX_COLLIDER_BOX : GX_COLLIDER_CAPSULE;
    if (capsule) {
        collider->size[0] = v[6];
        collider->size[1] = 0.5 * sqrt(square);
        collider->size[2] = 0;
    }
    place_collider(collider, center, capsule && square > 0 ? way : up);
    return 1;
}

static gx_material material_of(double young, double poisson, double density) {
    gx_material material;
    memset(&material, 0, sizeof material);
    material.elastic.kind = GXS_STABLE_NEO_HOOKEAN;
    material.elastic.young = young;
    material.elastic.poisson = poisson;
    material.density = density;
    return material;
}

/* CUT,E,NU,RHO. Returns NULL, or what is wrong with it. */
static const char *add_inclusion(settings *set, const char *text) {
    inclusion *added = &set->inclusions[set->inclusion_count];
    const char *end = text + strlen(text);
    size_t length;
    double v[3];
    int commas = 0;
    while (end > text && commas < 3) commas += *--end == ',';
    if (commas < 3 || end == text || gxio_argument_list(end + 1, v, 3, 3) != 3)
        return "is not CUT,E,NU,RHO with three finite numbers behind the surface";
    if (!(v[0] > 0.0)) return "must have Young's modulus above 0";
    if (!(v[1] >= 0.0 && v[1] < 0.5)) return "must have Poisson's ratio at least 0 and below 0.5";
    if (!(v[2] > 0.0)) return "must have a density above 0";
    length = (size_t)(end - text);
    added->cut = (char *)gxio_array(length + 1, 1);
    if (!added->cut) return "finds no memory";
    memcpy(added->cut, text, length);
    added->cut[length] = 0;
    added->material = material_of(v[0], v[1], v[2]);
    set->inclusion_count++;
    return NULL;
}

static void add_cut(settings *set, const char *spec, uint32_t kind) {
    set->kinds[set->cut_count] = kind;
    set->cuts[set->cut_count++] = spec;
}

/* Stores an option's value. Returns NULL, or what is wrong with it. */
static const char *store(settings *set, const option *o, const char *value) {
    switch (o->takes) {
    case TAKES_TEXT: *(const char **)o->target = value; return *value ? NULL : "is empty";
    case TAKES_NUMBER: return gxio_argument_number(value, (double *)o->target) ? NULL : "is not a finite number";
    case TAKES_COUNT: return parse_count(value, (uint32_t *)o->target) ? NULL : "is not a count from 0 to 1000000";
    case TAKES_VECTOR:
        return gxio_argument_list(value, (double *)o->target, 3, 3) == 3 ? NULL : "is not three finite numbers X,Y,Z";
    case TAKES_SHEET: add_cut(set, value, GX_SURFACE_SHEET); return NULL;
    case TAKES_SOLID: add_cut(set, value, GX_SURFACE_SOLID); return NULL;
    case TAKES_KEEP: add_cut(set, value, GX_SURFACE_KEEP); return NULL;
    case TAKES_COLLIDER:
        return parse_collider(value, &set->colliders[set->collider_count++])
                 ? NULL
                 : "is not sphere:X,Y,Z,RADIUS, box:X0,Y0,Z0,X1,Y1,Z1 or capsule:X0,Y0,Z0,X1,Y1,Z1,RADIUS";
    case TAKES_MATERIAL: return add_inclusion(set, value);
    default:
        return parse_region(value, &set->regions[set->region_count++])
                 ? NULL
                 : "is not AXIS<V or AXIS>V with the axis x, y or z, box:X0,Y0,Z0,X1,Y1,Z1 or sphere:X,Y,Z,RADIUS";
    }
}

/* The option that `name` names, or NULL. */
static option *find_option(option *options, const char *name) {
    for (; options->name; options++)
        if (strcmp(options->name, name) == 0) return options;
    return NULL;
}

/* Takes the argument at argv[*i] and its value, if it has one; *i is then the last one taken. */
static int take_argument(settings *set, option *options, int argc, char **argv, int *i, gxio_error *error) {
    const char *name = argv[*i], *value, *cause;
    option *o;
    if (name[0] != '-') {
        if (set->mesh) return gxio_fail(error, name, 0, "is a second mesh: one is enough");
        set->mesh = name;
        return 1;
    }
    o = find_option(options, name);
    if (!o) return misused(error, name, "unknown option, see gxcut --help");
    if (o->seen++ && o->takes <= TAKES_NOTHING) return misused(error, name, "is given twice");
    if (o->takes == TAKES_NOTHING) {
        *(int *)o->target = 1;
        return 1;
    }
    if (*i + 1 >= argc || strncmp(argv[*i + 1], "--", 2) == 0) return misused(error, name, "needs a value");
    value = argv[++*i];
    cause = store(set, o, value);
    return cause ? gxio_fail(error, name, 0, "'%s' %s", value, cause) : 1;
}

/* --static: one frame of up to 1000 iterations. What belongs to motion does not go with it. */
static int settle_options(settings *set, option *options, gxio_error *error) {
    static const char *const moving[4] = {"--frames", "--dt", "--cut-at", "--blade"};
    int i;
    for (i = 0; i < 4; i++)
        if (find_option(options, moving[i])->seen) return misused(error, moving[i], "does not go with --static");
    set->frames = 1;
    if (!find_option(options, "--newton")->seen) set->newton = 1000;
    return 1;
}

static int take_arguments(settings *set, int argc, char **argv, gxio_error *error) {
    option options[] = {{"--shape", TAKES_TEXT, &set->shape, 0},
                        {"--cells", TAKES_COUNT, &set->cells, 0},
                        {"--sheet", TAKES_SHEET, NULL, 0},
                        {"--solid", TAKES_SOLID, NULL, 0},
                        {"--keep", TAKES_KEEP, NULL, 0},
                        {"--material", TAKES_MATERIAL, NULL, 0},
                        {"--release", TAKES_NOTHING, &set->release, 0},
                        {"--thickness", TAKES_NUMBER, &set->thickness, 0},
                        {"--cut-at", TAKES_COUNT, &set->cut_at, 0},
                        {"--blade", TAKES_TEXT, &set->blade, 0},
                        {"--blade-tolerance", TAKES_NUMBER, &set->edge.tolerance, 0},
                        {"--blade-advance", TAKES_NUMBER, &set->edge.min_advance, 0},
                        {"--blade-inside", TAKES_NOTHING, &set->edge.starts_inside, 0},
                        {"--frames", TAKES_COUNT, &set->frames, 0},
                        {"--dt", TAKES_NUMBER, &set->dt, 0},
                        {"--static", TAKES_NOTHING, &set->rests, 0},
                        {"--newton", TAKES_COUNT, &set->newton, 0},
                        {"--young", TAKES_NUMBER, &set->young, 0},
                        {"--poisson", TAKES_NUMBER, &set->poisson, 0},
                        {"--density", TAKES_NUMBER, &set->density, 0},
                        {"--affine", TAKES_NUMBER, &set->affine, 0},
                        {"--gravity", TAKES_VECTOR, set->gravity, 0},
                        {"--fix", TAKES_REGION, NULL, 0},
                        {"--stretch", TAKES_VECTOR, set->stretch, 0},
                        {"--contact", TAKES_NOTHING, &set->contact, 0},
                        {"--friction", TAKES_NUMBER, &set->friction, 0},
                        {"--ground", TAKES_NUMBER, &set->ground, 0},
                        {"--collider", TAKES_COLLIDER, NULL, 0},
                        {"--sleep", TAKES_NUMBER, &set->sleep, 0},
                        {"--out", TAKES_TEXT, &set->out, 0},
                        {"--format", TAKES_TEXT, &set->format, 0},
                        {"--report", TAKES_TEXT, &set->report, 0},
                        {"--quiet", TAKES_NOTHING, &set->quiet, 0},
                        {"--help", TAKES_NOTHING, &set->help, 0},
                        {NULL, 0, NULL, 0}};
    const option *o;
    int i;
    for (i = 1; i < argc; i++)
        if (!take_argument(set, options, argc, argv, &i, error)) return 0;
    if (find_option(options, "--newton")->seen && !set->newton) return misused(error, "--newton", "must be at least 1");
    if (find_option(options, "--thickness")->seen && !(set->thickness > 0.0))
        return misused(error, "--thickness", "must be above 0");
    for (o = options; o->name && !set->blade; o++)
        if (o->seen && strncmp(o->name, "--blade-", strlen("--blade-")) == 0)
            return misused(error, o->name, "needs a --blade");
    for (o = options; o->name && !set->contact; o++)
        if (o->seen && (o->target == &set->friction || o->target == &set->ground || o->takes == TAKES_COLLIDER))
            return misused(error, o->name, "needs --contact");
    set->grounded = find_option(options, "--ground")->seen;
    return set->rests ? settle_options(set, options, error) : 1;
}

/* The ground becomes a collider, and all get names and friction. */
static void finish_colliders(settings *set) {
    static const double up[3] = {0, 0, 1};
    const double foot[3] = {0, 0, set->ground};
    size_t i;
    if (set->grounded) {
        gx_collider *ground = &set->colliders[set->collider_count++];
        memset(ground, 0, sizeof *ground);
        ground->kind = GX_COLLIDER_PLANE;
        place_collider(ground, foot, up);
    }
    for (i = 0; i < set->collider_count; i++) {
        set->colliders[i].id = (uint32_t)i;
        set->colliders[i].friction = set->friction;
    }
}

static int is_format(const settings *set, const char *format) { return strcmp(set->format, format) == 0; }

static int check_settings(const settings *set, gxio_error *error) {
    if (set->mesh && set->shape) return misused(error, "--shape", "stands in place of a mesh");
    if (!set->cells) return misused(error, "--cells", "must be at least 1");
    if (!set->mesh && !set->shape)
        return misused(error, "usage", "gxcut MESH [--sheet CUT]... [--solid CUT]... [options], see gxcut --help");
    if (!(set->dt > 0.0)) return misused(error, "--dt", "must be above 0");
    if (!(set->young > 0.0)) return misused(error, "--young", "must be above 0");
    if (!(set->poisson >= 0.0 && set->poisson < 0.5))
        return misused(error, "--poisson", "must be at least 0 and below 0.5");
    if (!(set->density > 0.0)) return misused(error, "--density", "must be above 0");
    if (set->release && !set->inclusion_count) return misused(error, "--release", "needs a --material");
    if (set->cut_at && set->cut_at >= set->frames)
        return misused(error, "--cut-at", "must be below the number of frames");
    if (set->blade && !set->frames) return misused(error, "--blade", "needs frames, and --frames is 0");
    if (!(set->edge.tolerance >= 0.0)) return misused(error, "--blade-tolerance", "must be at least 0");
    if (!(set->edge.min_advance >= 0.0)) return misused(error, "--blade-advance", "must be at least 0");
    if (!(set->friction >= 0.0)) return misused(error, "--friction", "must be at least 0");
    if (!(set->sleep >= 0.0)) return misused(error, "--sleep", "must be at least 0");
    if (!is_format(set, "vtu") && !is_format(set, "obj") && !is_format(set, "html"))
        return misused(error, "--format", "must be vtu, obj or html");
    return 1;
}

/* Defaults, then the arguments; cuts and regions can't be more than there are arguments. */
static int parse_settings(settings *set, int argc, char **argv, gxio_error *error) {
    const size_t room = (size_t)argc + 1;
    set->format = "vtu";
    set->dt = 0.033;
    set->young = 1e6;
    set->poisson = 0.4;
    set->density = 1000.0;
    set->gravity[2] = -9.81;
    set->stretch[0] = set->stretch[1] = set->stretch[2] = 1.0;
    set->frames = 60;
    set->cells = 16;
    set->cuts = (const char **)gxio_array(room, sizeof *set->cuts);
    set->kinds = (uint32_t *)gxio_array(room, sizeof *set->kinds);
    set->regions = (gx_region *)gxio_array(room, sizeof *set->regions);
    set->inclusions = (inclusion *)calloc(room, sizeof *set->inclusions);
    set->colliders = (gx_collider *)gxio_array(room, sizeof *set->colliders);
    if (!set->cuts || !set->kinds || !set->regions || !set->inclusions || !set->colliders)
        return misused(error, "arguments", "out of memory");
    if (!take_arguments(set, argc, argv, error)) return 0;
    finish_colliders(set);
    if (!set->out) set->out = is_format(set, "html") ? "out.html" : "out";
    return set->help ? 1 : check_settings(set, error);
}

/* ----------------------------------------------------------------------------------------------- >>input */

/* Ends the progress bar's line, so that what follows starts on its own. */
static void end_bar(run *r) {
    if (r->bar) fputc('\n', stderr);
    r->bar = 0;
}

static int complain(run *r, int code) {
    end_bar(r);
    fprintf(stderr, "gxcut: %s\n", r->error.text);
    return code;
}

/* A call on the body failed: "WHAT: field index: cause". */
static int fail(run *r, const char *what, const gx_failure *failure) {
    misused(&r->error, what, gxfailure_say(failure, gx_result_text(failure->result)).text);
    return complain(r, EXIT_FAILED);
}

static int lack_memory(run *r, const char *what) {
    misused(&r->error, what, "out of memory");
    return complain(r, EXIT_FAILED);
}

static int is_named(const gx_failure *failure, const char *field) {
    return failure->field && strcmp(failure->field, field) == 0;
}

/* The library refused the mesh: names the file, and the line of the node or element to blame. */
static int refuse_mesh(run *r, const gx_failure *failure) {
    const int node = is_named(failure, "positions");
    const char *path = node ? r->mesh.node_path : r->mesh.element_path, *text = gx_result_text(failure->result);
    const uint32_t *lines = node ? r->mesh.node_lines : r->mesh.element_lines;
    const size_t index = failure->index;
    if (!failure->field) return fail(r, "body", failure);
    if (index >= (node ? r->mesh.node_count : r->mesh.element_count))
        gxio_fail(&r->error, path, 0, "%s", gxfailure_say(failure, text).text);
    else
        gxio_fail(&r->error, path, lines ? lines[index] : 0, "%s %lu: %s", node ? "node" : "element",
                  (unsigned long)index, text);
    return complain(r, EXIT_MISUSED);
}

/* A cut failed: names it, and the line of the triangle to blame. */
static int refuse_cut(run *r, const gx_failure *failure) {
    const char *text = gx_result_text(failure->result);
    const size_t s = failure->surface, index = failure->index;
    const int vertex = is_named(failure, "surfaces.vertices") || is_named(failure, "vertices");
    if (s >= r->set.cut_count) return fail(r, "cut", failure);
    if (index == SIZE_MAX) {
        gx_failure of_cut = *failure;
        of_cut.surface = SIZE_MAX; /* "cut" says which */
        gxio_fail(&r->error, r->set.cuts[s], 0, "cut %lu: %s", (unsigned long)s, gxfailure_say(&of_cut, text).text);
    } else {
        const gxio_surface *cut = &r->cuts[s];
        const int known = cut->triangle_lines && !vertex && index < cut->triangle_count;
        gxio_fail(&r->error, r->set.cuts[s], known ? cut->triangle_lines[index] : 0, "cut %lu, %s %lu: %s",
                  (unsigned long)s, vertex ? "vertex" : "triangle", (unsigned long)index, text);
    }
    return complain(r, EXIT_FAILED);
}

static gx_surface surface_of(const gxio_surface *from, uint32_t kind) {
    gx_surface surface;
    memset(&surface, 0, sizeof surface);
    surface.vertices = from->vertices;
    surface.vertex_count = from->vertex_count;
    surface.triangles = from->triangles;
    surface.triangle_count = from->triangle_count;
    surface.kind = kind;
    return surface;
}

static gx_surface view_cut(const run *r, size_t i) { return surface_of(&r->cuts[i], r->set.kinds[i]); }

/* Replaces a sheet by a solid of the given thickness. Its triangles are new: no line of the file is theirs. */
static int thicken(run *r, size_t i) {
    const gx_surface sheet = view_cut(r, i);
    gxio_surface solid;
    gx_failure failure;
    gx_result result;
    memset(&solid, 0, sizeof solid);
    solid.vertices = (double *)gxio_array(sheet.vertex_count, 2 * 3 * sizeof(double));
    solid.triangles = (uint32_t *)gxio_array(sheet.triangle_count, 8 * 3 * sizeof(uint32_t));
    if (!solid.vertices || !solid.triangles) {
        gxio_surface_release(&solid);
        return lack_memory(r, r->set.cuts[i]);
    }
    result = gx_surface_solidify(&sheet, r->set.thickness, solid.vertices, &solid.vertex_count, solid.triangles,
                                 &solid.triangle_count, NULL, &failure);
    if (result != GX_OK) {
        failure.surface = i;
        gxio_surface_release(&solid);
        return refuse_cut(r, &failure);
    }
    gxio_surface_release(&r->cuts[i]);
    r->cuts[i] = solid;
    r->set.kinds[i] = GX_SURFACE_SOLID;
    return EXIT_DONE;
}

/* The mesh, or the surface of the shape in its place; and the box around it */
static int load_body(run *r, gxio_box *box) {
    size_t i;
    if (!r->set.shape) {
        if (!gxio_mesh_load(r->set.mesh, &r->mesh, &r->error)) return 0;
        gxio_mesh_bounds(&r->mesh, box->low, box->high);
        return 1;
    }
    for (i = 0; i < 3; i++) {
        box->low[i] = 0.0;
        box->high[i] = 1.0;
    }
    if (!gxio_surface_load(r->set.shape, box, &r->shape, &r->error)) return 0;
    for (i = 0; i < 3 * r->shape.vertex_count; i++) {
        const double x = r->shape.vertices[i];
        if (i < 3 || x < box->low[i % 3]) box->low[i % 3] = x;
        if (i < 3 || x > box->high[i % 3]) box->high[i % 3] = x;
    }
    return 1;
}

static int load(run *r) {
    gxio_box body;
    size_t i;
    int code = EXIT_DONE;
    if (!load_body(r, &body)) return complain(r, EXIT_MISUSED);
    r->cuts = (gxio_surface *)calloc(r->set.cut_count + 1, sizeof *r->cuts);
    if (!r->cuts) return lack_memory(r, "cuts");
    for (i = 0; i < r->set.cut_count; i++)
        if (!gxio_surface_load(r->set.cuts[i], &body, &r->cuts[i], &r->error)) return complain(r, EXIT_MISUSED);
    for (i = 0; i < r->set.inclusion_count; i++)
        if (!gxio_surface_load(r->set.inclusions[i].cut, &body, &r->set.inclusions[i].surface, &r->error))
            return complain(r, EXIT_MISUSED);
    for (i = 0; i < r->set.cut_count && code == EXIT_DONE && r->set.thickness > 0.0; i++)
        if (r->set.kinds[i] == GX_SURFACE_SHEET) code = thicken(r, i);
    if (code != EXIT_DONE || !r->set.blade) return code;
    return gxio_blade_load(r->set.blade, &r->edges, &r->error) ? EXIT_DONE : complain(r, EXIT_MISUSED);
}

/* Displacement u = (s - 1)(X - centre of the bounding box), component by component. */
static gx_result stretch(run *r, gx_failure *failure) {
    double low[3], high[3];
    size_t copy, axis;
    const gx_result result = gx_body_view(r->body, &r->view, failure);
    gxio_mesh_bounds(&r->mesh, low, high);
    for (copy = 0; result == GX_OK && copy < r->view.copy_count; copy++)
        for (axis = 0; axis < 3; axis++) {
            const double x = r->mesh.positions[3 * (size_t)r->view.copy_node[copy] + axis];
            r->view.displacement[3 * copy + axis] = (r->set.stretch[axis] - 1.0) * (x - 0.5 * (low[axis] + high[axis]));
        }
    return result;
}

static int make_blade(run *r) {
    gx_failure failure;
    r->strokes.min_link_ratio = 1.0;
    if (!r->set.blade) return EXIT_DONE;
    r->divided_at = (uint32_t *)calloc(r->mesh.element_count, sizeof *r->divided_at);
    if (!r->divided_at) return lack_memory(r, "--blade");
    if (gx_blade_create(r->body, &r->set.edge, &r->blade, &failure) != GX_OK) return fail(r, "--blade", &failure);
    return EXIT_DONE;
}

/* The body of the shape, and its grid as the mesh */
static int build_shape(run *r, gx_body_desc *desc) {
    const gx_surface surface = surface_of(&r->shape, GX_SURFACE_SOLID);
    gx_shape shape;
    gx_failure failure;
    memset(&shape, 0, sizeof shape);
    shape.surfaces = &surface;
    shape.surface_count = 1;
    shape.cells = r->set.cells;
    desc->shape = &shape;
    if (gx_body_create(desc, &r->body, &failure) != GX_OK) {
        fail(r, r->set.shape, &failure);
        return failure.field ? EXIT_MISUSED : EXIT_FAILED;
    }
    if (gx_body_view(r->body, &r->view, &failure) != GX_OK) return fail(r, "body", &failure);
    r->mesh.positions = (double *)gxio_array(r->view.node_count, 3 * sizeof(double));
    r->mesh.elements = (uint32_t *)gxio_array(r->view.element_count, 4 * sizeof(uint32_t));
    if (!r->mesh.positions || !r->mesh.elements) return lack_memory(r, r->set.shape);
    memcpy(r->mesh.positions, r->view.positions, r->view.node_count * 3 * sizeof(double));
    memcpy(r->mesh.elements, r->view.elements, r->view.element_count * 4 * sizeof(uint32_t));
    r->mesh.node_count = r->view.node_count;
    r->mesh.element_count = r->view.element_count;
    return EXIT_DONE;
}

/* The body of the mesh */
static int build_mesh(run *r, gx_body_desc *desc) {
    gx_failure failure;
    desc->positions = r->mesh.positions;
    desc->node_count = r->mesh.node_count;
    desc->elements = r->mesh.elements;
    desc->element_count = r->mesh.element_count;
    return gx_body_create(desc, &r->body, &failure) == GX_OK ? EXIT_DONE : refuse_mesh(r, &failure);
}

/* Contact, then the blade */
static int let_touch(run *r) {
    gx_contact_desc contact;
    gx_failure failure;
    memset(&contact, 0, sizeof contact);
    contact.friction = r->set.friction;
    return gx_body_contact(r->body, &contact, &failure) == GX_OK ? make_blade(r) : fail(r, "--contact", &failure);
}

/* Gives what lies inside of surfaces their material. */
static int include(run *r) {
    gx_surface *surfaces = (gx_surface *)gxio_array(r->set.inclusion_count, sizeof *surfaces);
    gx_cut_desc desc;
    gx_failure failure;
    gx_result result;
    size_t i;
    if (!surfaces) return lack_memory(r, "--material");
    for (i = 0; i < r->set.inclusion_count; i++) {
        surfaces[i] = surface_of(&r->set.inclusions[i].surface, GX_SURFACE_MATERIAL);
        surfaces[i].material = (uint32_t)i + 1;
    }
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = r->set.inclusion_count;
    result = gx_body_cut(r->body, &desc, NULL, &failure);
    free(surfaces);
    if (result == GX_OK) return EXIT_DONE;
    fail(r, failure.surface < r->set.inclusion_count ? r->set.inclusions[failure.surface].cut : "--material", &failure);
    return failure.field ? EXIT_MISUSED : EXIT_FAILED;
}

/* The materials: the body's, then those of --material. */
static gx_material *list_materials(const run *r) {
    gx_material *list = (gx_material *)gxio_array(r->set.inclusion_count + 1, sizeof *list);
    size_t i;
    if (!list) return NULL;
    list[0] = material_of(r->set.young, r->set.poisson, r->set.density);
    for (i = 0; i < r->set.inclusion_count; i++) list[i + 1] = r->set.inclusions[i].material;
    return list;
}

/* The body, stretched, then held: what is held stays where the stretch put it. */
static int build(run *r) {
    gx_body_desc desc;
    gx_material *materials;
    gx_failure failure;
    gx_result result;
    int code;
    memset(&desc, 0, sizeof desc);
    materials = list_materials(r);
    if (!materials) return lack_memory(r, "--material");
    desc.materials = materials;
    desc.material_count = r->set.inclusion_count + 1;
    desc.affine_below = r->set.affine;
    desc.clock = gxio_seconds;
    code = r->set.shape ? build_shape(r, &desc) : build_mesh(r, &desc);
    free(materials);
    if (code == EXIT_DONE && r->set.inclusion_count) code = include(r);
    if (code != EXIT_DONE) return code;
    result = stretch(r, &failure);
    if (result != GX_OK) return fail(r, "body", &failure);
    if (r->set.region_count) result = gx_body_hold(r->body, r->set.regions, r->set.region_count, &failure);
    if (result == GX_OK && r->set.contact) return let_touch(r);
    if (result == GX_OK) return make_blade(r);
    fail(r, "--fix", &failure);
    return failure.field ? EXIT_MISUSED : EXIT_FAILED;
}

/* ------------------------------------------------------------------------------------------------- >>cut */

/* All cuts in one call. */
static int cut(run *r) {
    static const uint32_t any[2] = {GX_ANY_MATERIAL, GX_ANY_MATERIAL};
    gx_surface *surfaces = (gx_surface *)gxio_array(r->set.cut_count, sizeof *surfaces);
    gx_cut_desc desc;
    gx_failure failure;
    gx_result result;
    size_t i;
    if (!surfaces) return lack_memory(r, "cut");
    for (i = 0; i < r->set.cut_count; i++) surfaces[i] = view_cut(r, i);
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = r->set.cut_count;
    desc.release = any;
    desc.release_count = r->set.release ? 1 : 0;
    result = gx_body_cut(r->body, &desc, &r->cut, &failure);
    free(surfaces);
    r->has_cut = result == GX_OK;
    return result == GX_OK ? EXIT_DONE : refuse_cut(r, &failure);
}

/* Creases of 34 degrees and more stay sharp. */
static const gx_skin_desc shading = {0.6, 1};

/* Looks at the body as it now is: view, and skin with room for its positions if frames are to be written. */
static int look(run *r) {
    gx_failure failure;
    if (gx_body_view(r->body, &r->view, &failure) != GX_OK) return fail(r, "surface", &failure);
    if (!r->set.frames) return EXIT_DONE;
    if (gx_body_skin(r->body, &shading, &r->skin, &failure) != GX_OK) return fail(r, "surface", &failure);
    free(r->skin_positions);
    free(r->skin_normals);
    r->skin_positions = (double *)gxio_array(r->skin.vertex_count, 3 * sizeof(double));
    r->has_mesh = 0;
    r->skin_normals = (float *)gxio_array(r->skin.vertex_count, 3 * sizeof(float));
    return r->skin_positions && r->skin_normals ? EXIT_DONE : lack_memory(r, "surface");
}

/* ---------------------------------------------------------------------------------------------- >>frames */

/* DIR/NAME; fails where it is too long. */
static int join_path(run *r, const char *name, char path[GXIO_PATH_ROOM]) {
    const int length = snprintf(path, GXIO_PATH_ROOM, "%s/%s", r->set.out, name);
    return length > 0 && length < GXIO_PATH_ROOM ? 1 : misused(&r->error, "--out", "the path is too long");
}

/* DIR/frame_NNNN.FORMAT */
static int write_file(run *r, const gxio_triangles *t, uint32_t frame) {
    char name[32], path[GXIO_PATH_ROOM];
    if (frame == 0 && !gxio_make_directory(r->set.out, &r->error)) return 0;
    gxio_frame_name(name, sizeof name, frame, r->set.format);
    if (!join_path(r, name, path)) return 0;
    return is_format(&r->set, "obj") ? gxio_write_obj(path, t, &r->error) : gxio_write_vtu(path, t, &r->error);
}

/* Against gravity; without any, along z */
static void find_up(const run *r, double up[3]) {
    int i;
    for (i = 0; i < 3; i++) up[i] = -r->set.gravity[i];
    if (!(fabs(up[0]) + fabs(up[1]) + fabs(up[2]) > 0.0)) up[2] = 1.0;
}

static int write_to_page(run *r, const gxio_triangles *t, uint32_t frame) {
    double up[3];
    find_up(r, up);
    if (!r->has_page && !gxio_page_open(&r->page, r->set.out, r->set.mesh ? r->set.mesh : r->set.shape, up, &r->error))
        return 0;
    r->has_page = 1;
    if (!r->has_mesh) gxio_page_mesh(&r->page, t, r->view.fragment_id);
    r->has_mesh = 1;
    gxio_page_frame(&r->page, t, (frame + 1.0) * r->set.dt);
    return 1;
}

static int write_frame(run *r, uint32_t frame) {
    gxio_triangles t;
    gx_body_skin_positions(r->body, r->skin_positions, NULL);
    gx_body_skin_vertices(r->body, NULL, NULL, r->skin_normals, NULL);
    t.positions = r->skin_positions;
    t.normals = r->skin_normals;
    t.texture = r->skin.vertex_texture;
    t.vertex_count = r->skin.vertex_count;
    t.triangles = r->skin.triangles;
    t.triangle_count = r->skin.triangle_count;
    t.fragment = r->skin.triangle_fragment;
    t.fragment_count = r->view.fragment_count;
    t.surface = r->skin.triangle_surface;
    t.material = r->skin.triangle_material;
    if (!(is_format(&r->set, "html") ? write_to_page(r, &t, frame) : write_file(r, &t, frame))) return 0;
    r->frames_written = frame + 1;
    return 1;
}

/* Completes the page, or writes the collection of the frames there are: also where a later step failed. */
static int finish_frames(run *r) {
    char path[GXIO_PATH_ROOM];
    if (r->has_page) {
        r->has_page = 0;
        return gxio_page_close(&r->page, 1, &r->error);
    }
    if (!r->frames_written || !is_format(&r->set, "vtu")) return 1;
    return join_path(r, "frames.pvd", path) && gxio_write_pvd(path, r->frames_written, r->set.dt, &r->error);
}

static void draw_bar(run *r, uint32_t done) {
    const int width = 40, filled = (int)((double)width * done / r->set.frames);
    int i;
    if (r->set.quiet || !STDERR_IS_TERMINAL) return;
    fputs("\r[", stderr);
    for (i = 0; i < width; i++) fputc(i < filled ? '#' : '.', stderr);
    fprintf(stderr, "] %lu/%lu", (unsigned long)done, (unsigned long)r->set.frames);
    fflush(stderr);
    r->bar = 1;
}

/* A frame failed: completes those before it, and says why and where they are. */
static int end_early(run *r, const char *name, size_t line, const char *cause) {
    if (!finish_frames(r)) return complain(r, EXIT_MISUSED);
    if (r->frames_written)
        gxio_fail(&r->error, name, line, "%s; the %lu frames before it are in %s", cause,
                  (unsigned long)r->frames_written, r->set.out);
    else
        gxio_fail(&r->error, name, line, "%s", cause);
    return complain(r, EXIT_FAILED);
}

/* ----------------------------------------------------------------------------------------------- >>blade */

/* The blade's edge of a line of its file failed. */
static int refuse_edge(run *r, size_t line, const gx_failure *failure) {
    char cause[256];
    const int inside = is_named(failure, "starts_inside");
    if (!inside && !is_named(failure, "edge"))
        snprintf(cause, sizeof cause, "%s", gxfailure_say(failure, gx_result_text(failure->result)).text);
    else
        snprintf(cause, sizeof cause, "point %lu of the edge: %s", (unsigned long)failure->index,
                 inside ? "the blade starts in the material, which --blade-inside allows"
                        : gx_result_text(failure->result));
    return end_early(r, r->set.blade, line, cause);
}

static void add_stroke(strokes *s, const gx_blade_report *report) {
    if (report->layer_count > s->layers) s->layers = report->layer_count;
    s->triangles += report->triangle_count;
    s->deviation = fmax(s->deviation, report->deviation);
    s->min_link_ratio = fmin(s->min_link_ratio, report->cut.min_link_ratio);
    s->seconds_arrangement += report->cut.seconds_arrangement;
    s->seconds_enrichment += report->cut.seconds_enrichment;
    s->seconds_integrals += report->cut.seconds_integrals;
}

/* Counts the elements to which the last cut gave slots from `before` on. Slots below element_count are the elements. */
static void count_divided(run *r, size_t before) {
    size_t slot;
    r->blade_cuts++;
    for (slot = before; slot < r->view.slot_count; slot++) {
        uint32_t element = (uint32_t)slot;
        while (r->view.slot_parent[element] != element) element = r->view.slot_parent[element];
        if (r->divided_at[element] != r->blade_cuts) r->strokes.divided++;
        r->divided_at[element] = r->blade_cuts;
    }
}

/* Moves the blade to an edge, or lifts it if the edge is NULL. */
static int move_blade(run *r, const gxio_edge *edge, size_t line) {
    const double start = gxio_seconds(NULL);
    const size_t slots = r->view.slot_count;
    gx_blade_report report = {0};
    gx_failure failure;
    int code;
    const gx_result result =
        edge ? gx_blade_move(r->blade, r->edges.points + 3 * edge->first, edge->count, NULL, 0, &report, &failure)
             : gx_blade_lift(r->blade, &report, &failure);
    if (result != GX_OK) return refuse_edge(r, line, &failure);
    r->strokes.seconds += gxio_seconds(NULL) - start;
    r->strokes.moves += edge != NULL;
    add_stroke(&r->strokes, &report);
    if (!report.triangle_count) return EXIT_DONE;
    code = look(r);
    if (code == EXIT_DONE) count_divided(r, slots);
    return code;
}

/* The line of the blade's file that is due after a frame's step. After the last one it is lifted. */
static int follow_blade(run *r, uint32_t frame) {
    const size_t i = frame < r->set.cut_at ? r->edges.edge_count : frame - r->set.cut_at;
    const gxio_edge *edge;
    int code = EXIT_DONE;
    if (i >= r->edges.edge_count) return EXIT_DONE;
    edge = &r->edges.edges[i];
    if (edge->count) code = move_blade(r, edge, edge->line);
    if (code != EXIT_DONE || (edge->count && i + 1 < r->edges.edge_count && frame + 1 < r->set.frames)) return code;
    return move_blade(r, NULL, edge->line);
}

/* ------------------------------------------------------------------------------------------------- >>run */

static int refuse_step(run *r, uint32_t frame, const gx_failure *failure) {
    const gxfailure_text cause = gxfailure_say(failure, gx_result_text(failure->result));
    char name[32];
    snprintf(name, sizeof name, "frame %lu", (unsigned long)frame);
    return end_early(r, name, 0, cause.text);
}

enum { STATIC_CG = 20000 };                  /* iterations in each of Newton's, at most */
static const double static_tolerance = 1e-8; /* residual of a balance */
static const double static_accepted = 1e-6;  /* where rounding or --newton ends the search above that */
static const double static_cg_tolerance = 1e-4;

/* The balance of forces is searched for until the residual is that of rounding; a coarse one is no balance. */
static int step(run *r, uint32_t frame) {
    gx_step_desc desc;
    gx_failure failure;
    memset(&desc, 0, sizeof desc);
    desc.dt = r->set.dt;
    memcpy(desc.gravity, r->set.gravity, sizeof desc.gravity);
    desc.newton_iterations = r->set.newton;
    desc.colliders = r->set.colliders;
    desc.collider_count = r->set.collider_count;
    desc.sleep_speed = r->set.sleep;
    if (r->set.rests) {
        desc.integrator = GXS_STATIC;
        desc.dt = 0.0;
        desc.newton_tolerance = static_tolerance;
        desc.cg_iterations = STATIC_CG;
        desc.cg_tolerance = static_cg_tolerance;
    }
    if (gx_body_step(r->body, &desc, &r->stepped, &failure) != GX_OK) return refuse_step(r, frame, &failure);
    r->seconds_newton += r->stepped.seconds;
    if (!r->set.rests || r->stepped.residual <= static_accepted) return EXIT_DONE;
    gxio_fail(&r->error, "--static", 0, "no balance after %lu iterations: a residual of %.1e is left",
              (unsigned long)r->stepped.newton_iterations, r->stepped.residual);
    return complain(r, EXIT_FAILED);
}

/* One frame: cut if it is time to, step, move the blade, write. */
static int advance(run *r, uint32_t frame) {
    int code = EXIT_DONE;
    if (frame == r->set.cut_at) {
        if (r->set.cut_count || r->set.release) code = cut(r);
        if (code == EXIT_DONE) code = look(r);
    }
    if (code == EXIT_DONE) code = step(r, frame);
    if (code == EXIT_DONE) code = follow_blade(r, frame);
    if (code != EXIT_DONE) return code;
    if (!write_frame(r, frame)) return complain(r, EXIT_MISUSED);
    draw_bar(r, frame + 1);
    return EXIT_DONE;
}

static int simulate(run *r) {
    uint32_t frame;
    int code = EXIT_DONE;
    if (!r->set.frames) {
        if (r->set.cut_count || r->set.release) code = cut(r);
        return code == EXIT_DONE ? look(r) : code;
    }
    if (r->set.cut_at) code = look(r);
    for (frame = 0; frame < r->set.frames && code == EXIT_DONE; frame++) code = advance(r, frame);
    end_bar(r);
    if (code == EXIT_DONE && !finish_frames(r)) code = complain(r, EXIT_MISUSED);
    return code;
}

/* ----------------------------------------------------------------------------------------------- >>depth */

static double mean_edge(const run *r) {
    double sum = 0;
    size_t e;
    int i, j, k;
    for (e = 0; e < r->view.element_count; e++)
        for (i = 0; i < 4; i++)
            for (j = 0; j < i; j++) {
                const double *a = r->view.positions + 3 * (size_t)r->view.elements[4 * e + (size_t)i];
                const double *b = r->view.positions + 3 * (size_t)r->view.elements[4 * e + (size_t)j];
                double square = 0;
                for (k = 0; k < 3; k++) square += (a[k] - b[k]) * (a[k] - b[k]);
                sum += sqrt(square);
            }
    return r->view.element_count ? sum / (6.0 * (double)r->view.element_count) : 1.0;
}

/* The collider as gxoverlap.h has it: a ball and a capsule are a point and a segment with a radius. */
static gxoverlap_round round_of(const gx_collider *collider) {
    gxoverlap_round round;
    memset(&round, 0, sizeof round);
    memcpy(round.pose, collider->pose, sizeof round.pose);
    if (collider->kind == GX_COLLIDER_BOX)
        memcpy(round.half, collider->size, sizeof round.half);
    else
        round.radius = collider->size[0];
    if (collider->kind == GX_COLLIDER_CAPSULE) round.half[2] = collider->size[1];
    return round;
}

/* How deep the skin of a piece is in other pieces, in its own, below the ground or in a collider at most, m, within a
   tolerance. It is measured on what is drawn. Returns below 0 where there is no memory. */
static double deepest(run *r, double tolerance) {
    gxoverlap_surface surface;
    gxoverlap_forest forest;
    double most = -1.0;
    size_t i;
    if (!r->set.frames) return 0.0;
    if (look(r) != EXIT_DONE) return -1.0; /* the skin may be one of another shading by now */
    if (gx_body_skin_positions(r->body, r->skin_positions, NULL) != GX_OK) return -1.0;
    surface.positions = r->skin_positions;
    surface.triangles = r->skin.triangles;
    surface.pieces = r->skin.triangle_fragment;
    surface.triangle_count = r->skin.triangle_count;
    if (gxoverlap_make(&forest, &surface)) {
        most = fmax(gxoverlap_of_pieces(&forest, tolerance).depth, gxoverlap_of_itself(&forest).depth);
        gxoverlap_release(&forest);
    }
    for (i = 0; i < r->set.collider_count && most >= 0; i++) {
        const gxoverlap_round round = round_of(&r->set.colliders[i]);
        const int plane = r->set.colliders[i].kind == GX_COLLIDER_PLANE;
        most = fmax(most, plane ? gxoverlap_in_convex(&surface, gxoverlap_from_ground, &r->set.ground, tolerance).depth
                                : gxoverlap_in_convex(&surface, gxoverlap_from_round, &round, tolerance).depth);
    }
    return most;
}

/* ---------------------------------------------------------------------------------------------- >>report */

static void print_contact(FILE *stream, run *r) {
    const double edge = mean_edge(r), depth = deepest(r, 1e-3 * edge);
    gx_motion *motions = (gx_motion *)gxio_array(r->view.fragment_count, sizeof *motions);
    size_t i, count = 0;
    (void)gx_body_contacts(r->body, NULL, 0, &count, NULL);
    fprintf(stream, "  \"contacts\": %lu,\n  \"max_penetration\": %.17g,\n  \"energy\": %.17g,\n  \"asleep\": %s,\n",
            (unsigned long)count, depth / edge, r->stepped.energy,
            r->stepped.stop == GXS_STOP_ASLEEP ? "true" : "false");
    fputs("  \"fragment_centers\": [", stream);
    if (motions && gx_body_motion(r->body, motions, r->view.fragment_count, NULL) == GX_OK)
        for (i = 0; i < r->view.fragment_count; i++) {
            const double *c = motions[i].center;
            fprintf(stream, "%s[%.17g, %.17g, %.17g]", i ? ", " : "", c[0], c[1], c[2]);
        }
    fputs("],\n", stream);
    free(motions);
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double smallest_link(const run *r) {
    return fmin(r->has_cut ? r->cut.min_link_ratio : 1.0, r->strokes.min_link_ratio);
}

static double us_per_divided_element(const strokes *s) {
    return s->divided ? 1e6 * s->seconds / (double)s->divided : 0.0;
}

static void print_blade(FILE *stream, const strokes *s) {
    fprintf(stream,
            "  \"blade\": {\"moves\": %lu, \"layers\": %lu, \"triangles\": %lu, \"deviation\": %.17g, "
            "\"divided_elements\": %lu, \"us_per_divided_element\": %.17g},\n",
            (unsigned long)s->moves, (unsigned long)s->layers, (unsigned long)s->triangles, s->deviation,
            (unsigned long)s->divided, us_per_divided_element(s));
}

/* "name": [values, ascending]; sorts them in place. */
static void print_volumes(FILE *stream, const char *name, double *values, size_t count) {
    size_t i;
    if (count) qsort(values, count, sizeof *values, compare_doubles);
    fprintf(stream, "\"%s\": [", name);
    for (i = 0; i < count; i++) fprintf(stream, "%s%.17g", i ? ", " : "", values[i]);
    fputc(']', stream);
}

/* Cells of view are sorted by element: the end of those of element e that begin at `cell`. */
static size_t cells_end(const gx_view *view, size_t cell, size_t e) {
    while (cell < view->cell_count && view->cell_element[cell] == e) cell++;
    return cell;
}

static void print_cells(FILE *stream, const gx_view *view, double *volumes) {
    size_t e, cell = 0, end;
    char name[24];
    fprintf(stream, "  \"cells_per_element\": [");
    for (e = 0; e < view->element_count; e++, cell = end) {
        end = cells_end(view, cell, e);
        fprintf(stream, "%s%lu", e ? ", " : "", (unsigned long)(end - cell));
    }
    fprintf(stream, "],\n  \"cell_volumes\": {");
    for (e = 0, cell = 0; e < view->element_count; e++, cell = end) {
        end = cells_end(view, cell, e);
        fputs(e ? ",\n    " : "\n    ", stream);
        snprintf(name, sizeof name, "%lu", (unsigned long)e);
        print_volumes(stream, name, volumes + cell, end - cell);
    }
    fprintf(stream, "\n  },\n");
}

/* Volumes and masses of the materials, in their order */
static void print_materials(FILE *stream, const run *r) {
    size_t m, i;
    fprintf(stream, "  \"materials\": [");
    for (m = 0; m <= r->set.inclusion_count; m++) {
        const double density = m ? r->set.inclusions[m - 1].material.density : r->set.density;
        double volume = 0.0;
        for (i = 0; i < r->view.cell_count; i++)
            if ((r->view.cell_material ? r->view.cell_material[i] : 0) == m) volume += r->view.cell_volume[i];
        fprintf(stream, "%s{\"volume\": %.17g, \"mass\": %.17g}", m ? ", " : "", volume, density * volume);
    }
    fprintf(stream, "],\n");
}

static size_t count_affine(const gx_view *view) {
    size_t i, count = 0;
    for (i = 0; view->copy_affine && i < view->copy_count; i++) count += view->copy_affine[i];
    return count;
}

/* Displacements and, of affine copies, motions */
static size_t count_unknowns(const gx_view *view) { return 3 * view->copy_count + 9 * count_affine(view); }

/* The largest displacement of a vertex of the skin, m */
static gx_result find_tip(run *r, double *tip, gx_failure *failure) {
    gx_skin skin;
    gx_result result = gx_body_skin(r->body, &shading, &skin, failure); /* the one of the frames */
    double *x = NULL;
    size_t i;
    *tip = 0.0;
    if (result == GX_OK) x = (double *)gxio_array(skin.vertex_count, 3 * sizeof(double));
    if (result == GX_OK && !x) return failure->result = GX_ERROR_MEMORY;
    if (result == GX_OK) result = gx_body_skin_positions(r->body, x, failure);
    for (i = 0; result == GX_OK && i < 3 * skin.vertex_count; i += 3) {
        const double *rest = skin.vertex_rest + i;
        const double u[3] = {x[i] - rest[0], x[i + 1] - rest[1], x[i + 2] - rest[2]};
        *tip = fmax(*tip, sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
    }
    free(x);
    return result;
}

static void print_report(FILE *stream, run *r, uint64_t hash, double tip, double *cell_volumes,
                         double *fragment_volumes) {
    const gx_view *view = &r->view;
    fprintf(stream, "{\n  \"elements\": %lu,\n  \"nodes\": %lu,\n  \"cells\": %lu,\n",
            (unsigned long)view->element_count, (unsigned long)view->node_count, (unsigned long)view->cell_count);
    print_cells(stream, view, cell_volumes);
    fprintf(stream, "  \"copies\": %lu,\n  \"fragments\": %lu,\n  ", (unsigned long)view->copy_count,
            (unsigned long)view->fragment_count);
    print_volumes(stream, "fragment_volumes", fragment_volumes, view->fragment_count);
    fprintf(stream, ",\n  \"volume\": %.17g,\n  \"dofs\": %lu,\n  \"mass\": %.17g,\n", view->volume,
            (unsigned long)count_unknowns(view), view->mass);
    fprintf(stream, "  \"affine_copies\": %lu,\n  \"tip\": %.17g,\n", (unsigned long)count_affine(view), tip);
    if (r->set.rests)
        fprintf(stream, "  \"newton_iterations\": %lu,\n  \"cg_iterations\": %lu,\n  \"residual\": %.17g,\n",
                (unsigned long)r->stepped.newton_iterations, (unsigned long)r->stepped.cg_iterations,
                r->stepped.residual);
    fprintf(stream, "  \"topology_hash\": \"%08lx%08lx\",\n  \"min_link_ratio\": %.17g,\n", (unsigned long)(hash >> 32),
            (unsigned long)(hash & 0xffffffffu), smallest_link(r));
    fprintf(stream,
            "  \"timings\": {\"arrangement\": %.17g, \"enrichment\": %.17g, \"integrals\": %.17g, \"newton\": %.17g, "
            "\"total\": %.17g},\n",
            r->cut.seconds_arrangement + r->strokes.seconds_arrangement,
            r->cut.seconds_enrichment + r->strokes.seconds_enrichment,
            r->cut.seconds_integrals + r->strokes.seconds_integrals, r->seconds_newton,
            gxio_seconds(NULL) - r->seconds_start);
    if (r->set.inclusion_count) print_materials(stream, r);
    if (r->blade) print_blade(stream, &r->strokes);
    if (r->set.contact) print_contact(stream, r);
    fprintf(stream, "  \"frames\": %lu\n}\n", (unsigned long)r->set.frames);
}

static double *copy_doubles(const double *values, size_t count) {
    double *copy = (double *)gxio_array(count, sizeof *copy);
    if (copy && count) memcpy(copy, values, count * sizeof *copy);
    return copy;
}

static int report(run *r) {
    gx_failure failure;
    const uint64_t hash = gx_body_topology_hash(r->body, &failure);
    double *cells = copy_doubles(r->view.cell_volume, r->view.cell_count);
    double *fragments = copy_doubles(r->view.fragment_volume, r->view.fragment_count);
    gxio_writer writer;
    double tip = 0.0;
    int code = EXIT_DONE;
    if (failure.result != GX_OK || find_tip(r, &tip, &failure) != GX_OK)
        code = fail(r, "report", &failure);
    else if (!cells || !fragments)
        code = lack_memory(r, "report");
    else if (!gxio_writer_open(&writer, r->set.report, &r->error))
        code = complain(r, EXIT_MISUSED);
    else {
        print_report(writer.stream, r, hash, tip, cells, fragments);
        if (!gxio_writer_close(&writer, 1, &r->error)) code = complain(r, EXIT_MISUSED);
    }
    free(cells);
    free(fragments);
    return code;
}

static void summarise_frames(const run *r) {
    char first[32], last[32];
    if (!r->set.frames) return;
    if (r->set.rests)
        printf("balance   %lu iterations, %lu of conjugate gradients, %.3g s; residual %.1e\n",
               (unsigned long)r->stepped.newton_iterations, (unsigned long)r->stepped.cg_iterations, r->seconds_newton,
               r->stepped.residual);
    else
        printf("steps     %lu of %g s, %.3g ms each\n", (unsigned long)r->set.frames, r->set.dt,
               1e3 * r->seconds_newton / r->set.frames);
    if (is_format(&r->set, "html")) {
        printf("wrote     %s; open it in a browser\n", r->set.out);
        return;
    }
    gxio_frame_name(first, sizeof first, 0, r->set.format);
    gxio_frame_name(last, sizeof last, r->set.frames - 1, r->set.format);
    printf("wrote     %s/%s to %s", r->set.out, first, last);
    if (is_format(&r->set, "vtu")) printf("; ParaView opens %s/frames.pvd", r->set.out);
    putchar('\n');
}

static void summarise_blade(const strokes *s) {
    printf("blade     %lu moves, at most %lu layers: %lu triangles, at most %.3g m off its path\n",
           (unsigned long)s->moves, (unsigned long)s->layers, (unsigned long)s->triangles, s->deviation);
    printf("          %lu elements divided, %.3g us each; smallest link %.3g of its face\n", (unsigned long)s->divided,
           us_per_divided_element(s), s->min_link_ratio);
}

static void summarise(const run *r) {
    const gx_view *view = &r->view;
    printf("mesh      %s: %lu nodes, %lu elements\n", r->set.mesh ? r->set.mesh : r->set.shape,
           (unsigned long)view->node_count, (unsigned long)view->element_count);
    if (r->has_cut)
        printf("cuts      %lu: %lu elements touched, smallest link %.3g of its face, removed volume %.6g m3\n",
               (unsigned long)r->set.cut_count, (unsigned long)r->cut.touched_elements, r->cut.min_link_ratio,
               r->cut.removed_volume);
    if (r->blade) summarise_blade(&r->strokes);
    printf("body      %lu cells, %lu fragments, volume %.15g m3, mass %.6g kg\n", (unsigned long)view->cell_count,
           (unsigned long)view->fragment_count, view->volume, view->mass);
    if (count_affine(view))
        printf("unknowns  %lu copies x 3 + %lu affine ones x 9 = %lu\n", (unsigned long)view->copy_count,
               (unsigned long)count_affine(view), (unsigned long)count_unknowns(view));
    else
        printf("unknowns  %lu copies x 3 = %lu\n", (unsigned long)view->copy_count,
               (unsigned long)count_unknowns(view));
    if (r->has_cut)
        printf("cut time  %.3g ms: arrangement %.3g, enrichment %.3g, integrals %.3g\n",
               1e3 * (r->cut.seconds_arrangement + r->cut.seconds_enrichment + r->cut.seconds_integrals),
               1e3 * r->cut.seconds_arrangement, 1e3 * r->cut.seconds_enrichment, 1e3 * r->cut.seconds_integrals);
    summarise_frames(r);
    if (r->set.report) printf("report    %s\n", r->set.report);
}

static void release(run *r) {
    size_t i;
    if (r->has_page) finish_frames(r); /* a cut failed: the frames before it stay, as files do */
    for (i = 0; r->cuts && i < r->set.cut_count; i++) gxio_surface_release(&r->cuts[i]);
    free(r->cuts);
    gxio_blade_release(&r->edges);
    free(r->divided_at);
    free(r->skin_positions);
    free(r->skin_normals);
    gx_body_destroy(r->body);
    gxio_mesh_release(&r->mesh);
    gxio_surface_release(&r->shape);
    for (i = 0; i < r->set.inclusion_count; i++) {
        free(r->set.inclusions[i].cut);
        gxio_surface_release(&r->set.inclusions[i].surface);
    }
    free(r->set.inclusions);
    free((void *)r->set.cuts);
    free(r->set.kinds);
    free(r->set.regions);
    free(r->set.colliders);
}

static int execute(run *r, int argc, char **argv) {
    int code;
    if (!parse_settings(&r->set, argc, argv, &r->error)) return complain(r, EXIT_MISUSED);
    if (r->set.help) {
        fputs(usage, stdout);
        fputs(usage_rest, stdout);
        return EXIT_DONE;
    }
    code = load(r);
    if (code == EXIT_DONE) code = build(r);
    if (code == EXIT_DONE) code = simulate(r);
    if (code == EXIT_DONE && r->set.report) code = report(r);
    if (code == EXIT_DONE && !r->set.quiet) summarise(r);
    return code;
}

int main(int argc, char **argv) {
    run r;
    int code;
    memset(&r, 0, sizeof r);
    r.seconds_start = gxio_seconds(NULL);
    code = execute(&r, argc, argv);
    release(&r);
    return code;
}
