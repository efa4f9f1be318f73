/* The turtle: derived symbols to spheres and ellipsoids (Prusinkiewicz and Lindenmayer 1990, section 1.5; Jiménez
 * 2018, section 3.6.2 and Figure 11). Turns are rotations of the turtle's own three axes, in double precision by
 * plain IEEE operations; a turn changes their length by 1e-16, so a million turns need no mending. */
#include "shape/turtle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/random_inline.h"
#include "generate/grammar_private.h"

enum { STREAM_TURTLE = 16 }; /* of a symbol's key; see derive.c for the others */

static const double farthest = 1e9; /* metres; single precision is useless beyond */

/* What '[' keeps and ']' restores. head x left = up. */
typedef struct pose {
    shape_dvec3 position, head, left, up;
    double radius_factor, length_factor; /* by '!' */
    double stretch[3];                   /* right, forward, up; by '@' */
} pose;

struct shape_turtle {
    const char *name;
    bool puffs[LETTERS];
    shape_grammar_range angle, radius, length, shrink;
    shape_primitives *list;
    pose now;
    pose *kept;
    size_t kept_count, kept_capacity;
    char name_text[]; /* behind name */
};

shape_turtle *shape_turtle_create(const shape_grammar *grammar, const shape_derive_options *options,
                                  shape_primitives *list, shape_error *error)
{
    size_t length = strlen(grammar->name);
    shape_turtle *t = calloc(1, sizeof *t + length + 1);
    if (!t) {
        shape_error_memory(error);
        return NULL;
    }
    memcpy(t->name_text, grammar->name, length + 1);
    t->name = t->name_text;
    memcpy(t->puffs, grammar->puffs, sizeof t->puffs);
    t->angle = options->angle;
    t->radius = options->radius;
    t->length = options->length;
    t->shrink = options->shrink;
    t->list = list;
    pose start = {
        .head = {0, 1, 0}, .left = {-1, 0, 0}, .up = {0, 0, 1}, .radius_factor = 1, .length_factor = 1};
    memcpy(start.stretch, grammar->settings.stretch, sizeof start.stretch);
    t->now = start;
    return t;
}

void shape_turtle_destroy(shape_turtle *turtle)
{
    if (turtle)
        free(turtle->kept);
    free(turtle);
}

static shape_status refuse(const shape_turtle *t, const shape_symbol *s, shape_status status,
                           const char *what, double value, const char *remedy, shape_error *error)
{
    return shape_error_set(error, status, "%s:%d:%d: %s is %g (%s)", t->name, s->line, s->column, what, value,
                           remedy);
}

/* The sine and cosine of an angle in degrees, exact at every quarter turn. */
static void turn_factors(double degrees, double *sine, double *cosine)
{
    static const double radians = 0x1.1df46a2529d39p-6;
    double turns = degrees / 90 + 0.5;
    int64_t quarters = (int64_t)turns; /* turn_by keeps this far within the range */
    quarters -= (double)quarters > turns;
    double rest = (degrees - (double)quarters * 90) * radians;
    double s, c;
    shape_sin_cos(rest, &s, &c);
    int quarter = (int)(quarters & 3);
    *sine = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
    *cosine = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
}

/* Turns axis a towards axis b by an angle, and b away from a. */
static inline void turn(shape_dvec3 *a, shape_dvec3 *b, double degrees)
{
    double s, c;
    turn_factors(degrees, &s, &c);
    shape_dvec3 old = *a;
    *a = shape_dvec3_add(shape_dvec3_scale(old, c), shape_dvec3_scale(*b, s));
    *b = shape_dvec3_sub(shape_dvec3_scale(*b, c), shape_dvec3_scale(old, s));
}

static double draw(const shape_symbol *symbol, shape_random *random, bool *seeded, shape_grammar_range range)
{
    if (range.low == range.high)
        return range.low;
    if (!*seeded)
        *random = random_seed(symbol->key, STREAM_TURTLE);
    *seeded = true;
    return random_range(random, range.low, range.high);
}

static shape_status turn_by(shape_turtle *t, const shape_symbol *s, shape_error *error)
{
    shape_random random;
    bool seeded = false;
    pose *p = &t->now;
    double degrees = s->argument_count ? s->arguments[0] : draw(s, &random, &seeded, t->angle);
    if (!(fabs(degrees) <= 1e9))
        return refuse(t, s, SHAPE_ERROR_ARGUMENT, "the turn", degrees, "keep it within 1e9 degrees", error);
    switch (s->letter) {
    case '+':
        turn(&p->head, &p->left, degrees);
        break;
    case '-':
        turn(&p->head, &p->left, -degrees);
        break;
    case '&':
        turn(&p->head, &p->up, -degrees);
        break;
    case '^':
        turn(&p->head, &p->up, degrees);
        break;
    case '\\':
        turn(&p->up, &p->left, degrees);
        break;
    case '/':
        turn(&p->up, &p->left, -degrees);
        break;
    default: /* '|' */
        turn(&p->head, &p->left, 180);
        break;
    }
    return SHAPE_OK;
}

static shape_status keep(shape_turtle *t, const shape_symbol *s, shape_error *error)
{
    if (t->kept_count == SHAPE_GRAMMAR_BRACKETS_MAX)
        return refuse(t, s, SHAPE_ERROR_LIMIT, "the number of open brackets", (double)t->kept_count + 1,
                      "lower the iterations", error);
    if (shape_array_reserve((void **)&t->kept, &t->kept_capacity, t->kept_count + 1, sizeof *t->kept, error))
        return SHAPE_ERROR_MEMORY;
    t->kept[t->kept_count++] = t->now;
    return SHAPE_OK;
}

static shape_status advance(shape_turtle *t, const shape_symbol *s, double step, shape_error *error)
{
    pose *p = &t->now;
    p->position = shape_dvec3_add(p->position, shape_dvec3_scale(p->head, step));
    double x = fabs(p->position.x), y = fabs(p->position.y), z = fabs(p->position.z);
    if (!(x <= farthest && y <= farthest && z <= farthest)) {
        double far = fmax(x, fmax(y, z));
        return refuse(t, s, SHAPE_ERROR_LIMIT, "the distance from the origin", far, "keep it within 1e9 m",
                      error);
    }
    return SHAPE_OK;
}

/* '!': the factor on the radius and length of what follows, given or drawn from shrink. */
static shape_status scale_pose(shape_turtle *t, const shape_symbol *s, shape_error *error)
{
    shape_random random;
    bool seeded = false;
    double radius = s->argument_count ? s->arguments[0] : draw(s, &random, &seeded, t->shrink);
    double length = s->argument_count == 2 ? s->arguments[1] : radius;
    if (!(radius > 0))
        return refuse(t, s, SHAPE_ERROR_ARGUMENT, "the factor on the radius", radius,
                      "make it greater than 0", error);
    if (!(length >= 0))
        return refuse(t, s, SHAPE_ERROR_ARGUMENT, "the factor on the length", length, "make it 0 or more",
                      error);
    t->now.radius_factor *= radius;
    t->now.length_factor *= length;
    return SHAPE_OK;
}

static shape_status set_stretch(shape_turtle *t, const shape_symbol *s, shape_error *error)
{
    for (int i = 0; i < 3; i++) {
        double factor = s->argument_count == 3 ? s->arguments[i] : 1;
        if (!(factor >= 1e-6 && factor <= 1e6))
            return refuse(t, s, SHAPE_ERROR_ARGUMENT, "a stretch factor", factor, "make it 1e-6 to 1e6",
                          error);
        t->now.stretch[i] = factor;
    }
    return SHAPE_OK;
}

static shape_status set_primitive(shape_turtle *t, double radius, shape_error *error)
{
    const pose *p = &t->now;
    const double *f = p->stretch;
    float x = (float)p->position.x, y = (float)p->position.y, z = (float)p->position.z;
    if (f[0] == f[1] && f[1] == f[2]) {
        shape_sphere sphere = {x, y, z, (float)(radius * f[0])};
        return shape_primitives_add_sphere(t->list, sphere, error);
    }
    shape_ellipsoid ellipsoid = {.x = x,
                                 .y = y,
                                 .z = z,
                                 .a = (float)(radius * f[0]),
                                 .b = (float)(radius * f[1]),
                                 .c = (float)(radius * f[2]),
                                 .q =
                                     shape_quat_from_columns(shape_dvec3_scale(p->left, -1), p->head, p->up)};
    return shape_primitives_add_ellipsoid(t->list, ellipsoid, error);
}

static shape_status puff(shape_turtle *t, const shape_symbol *s, shape_error *error)
{
    shape_random random;
    bool seeded = false;
    /* Both are drawn in this order whether or not they are needed, so that giving one leaves the other as it was. */
    double radius = draw(s, &random, &seeded, t->radius) * s->scale * t->now.radius_factor;
    double step = draw(s, &random, &seeded, t->length) * s->scale * t->now.length_factor;
    if (s->argument_count > 0)
        radius = s->arguments[0];
    if (s->argument_count > 1)
        step = s->arguments[1];
    if (!(radius >= 1e-9 && radius <= 1e9))
        return refuse(t, s, SHAPE_ERROR_ARGUMENT, "the radius", radius,
                      "make it greater than 0, at most 1e9 m, by shrink, a condition or max", error);
    shape_error inner;
    shape_status status = set_primitive(t, radius, &inner);
    if (status == SHAPE_ERROR_MEMORY)
        return shape_error_memory(error);
    if (status)
        return shape_error_set(error, status, "%s:%d:%d: %s", t->name, s->line, s->column, inner.text);
    return advance(t, s, step, error);
}

static shape_status glide(shape_turtle *t, const shape_symbol *s, shape_error *error)
{
    shape_random random;
    bool seeded = false;
    double step = s->argument_count ? s->arguments[0]
                                    : draw(s, &random, &seeded, t->length) * s->scale * t->now.length_factor;
    return advance(t, s, step, error);
}

shape_status shape_turtle_visit(shape_turtle *t, const shape_symbol *s, shape_error *error)
{
    if ((unsigned char)s->letter < LETTERS && t->puffs[(unsigned char)s->letter])
        return puff(t, s, error);
    switch (s->letter) {
    case '+':
    case '-':
    case '&':
    case '^':
    case '\\':
    case '/':
    case '|':
        return turn_by(t, s, error);
    case 'G':
        return glide(t, s, error);
    case '[':
        return keep(t, s, error);
    case ']':
        if (t->kept_count)
            t->now = t->kept[--t->kept_count];
        return SHAPE_OK;
    case '!':
        return scale_pose(t, s, error);
    case '@':
        return set_stretch(t, s, error);
    default:
        return SHAPE_OK;
    }
}

static shape_status visit(void *user, const shape_symbol *symbol, shape_error *error)
{
    return shape_turtle_visit(user, symbol, error);
}

shape_status shape_grammar_grow(const shape_grammar *grammar, const shape_derive_options *options,
                                shape_primitives *list, shape_derive_counts *counts, shape_error *error)
{
    shape_turtle *turtle = shape_turtle_create(grammar, options, list, error);
    if (!turtle)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_grammar_derive(grammar, options, visit, turtle, counts, error);
    shape_turtle_destroy(turtle);
    return status;
}
