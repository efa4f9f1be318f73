/* neph-chart's parts: the settings that are measured, the measuring, the front of the best, and what is written. */
#ifndef NEPHELE_CHART_H
#define NEPHELE_CHART_H

#include <stdio.h>

#include "shape/march.h"
#include "shape/set.h"
#include "shape/view.h"
#include "shape/volume.h"

/* --- chart_methods.c: what is measured --- */

typedef enum chart_method {
    CHART_MARCH,
    CHART_PAPER,
    CHART_PAPER_NDT,
    CHART_GL,
    CHART_GL_EXACT,
    CHART_GL_PAPER,
    CHART_GL_PAPER_NDT,
    CHART_METHODS
} chart_method;

/* What is done to the primitives beforehand, not counted in the time. */
typedef enum chart_change {
    CHART_AS_IS,
    CHART_PRUNED,   /* those inside others go */
    CHART_HOLLOWED, /* the core goes */
    CHART_HALVED,   /* a random half goes */
    CHART_CHANGES
} chart_change;

/* Two times are of interest. */
typedef enum chart_kind {
    CHART_PICTURE, /* from the volume in memory: light, baking, drawing */
    CHART_FRAME,   /* drawing alone, light and baking done before */
    CHART_KINDS
} chart_kind;

typedef struct chart_setting {
    chart_method method;
    shape_rule rule;
    int steps;               /* along the longest side of all clouds */
    shape_march_light light; /* of CHART_GL and CHART_GL_EXACT: single, powder, octaves or grid */
    shape_march_shadow shadow;
    shape_march_jitter jitter;
    int cells;   /* of the light grid's longest side */
    int samples; /* a pixel */
    int voxels;  /* thousands, of the baked density at most; of CHART_GL */
    bool moving; /* the viewer's picture of a moving view; of CHART_GL */
    int octaves; /* of the noise at most; 0: the clouds' own */
    chart_change change;
    int shrink; /* drawn so many times smaller each way, then enlarged; 0 and 1: not */
    bool quick; /* measured by --quick too */
} chart_setting;

extern const chart_setting chart_settings[];
extern const size_t chart_setting_count;

enum { CHART_TEXT = 128, CHART_DIGEST = 16, CHART_RUNS = 99 };

const char *chart_method_name(chart_method method);
bool chart_method_is_gl(chart_method method);
/* Whether a setting of the table is its method as the program has it. */
bool chart_setting_is_default(const chart_setting *setting);
/* The same for a picture or a frame: of the viewer's method, which draws a moving view in another way, the frame is that one. */
bool chart_setting_is_default_of(const chart_setting *setting, chart_kind kind);
/* Everything that sets it apart, without commas. */
void chart_setting_text(const chart_setting *setting, char text[CHART_TEXT]);
/* For the picture: what is not as usual. */
void chart_setting_label(const chart_setting *setting, char text[CHART_TEXT]);
/* A copy of the set with the setting's octaves and change; *changed is false where octaves or change
 * were asked for and make no difference. The caller destroys *made. */
shape_status chart_setting_apply(const chart_setting *setting, const shape_set *set, shape_set **made,
                                 bool *changed, shape_error *error);

/* --- results --- */

/* A setting on a scene. */
typedef struct chart_row {
    const chart_setting *setting;
    char text[CHART_TEXT], digest[CHART_DIGEST + 1];
    int runs[CHART_KINDS];
    double times[CHART_KINDS][CHART_RUNS]; /* milliseconds */
    double relmse, plain_relmse,
        exposure; /* relmse after the best exposure; the reference's noise taken off */
    bool front[CHART_KINDS];
} chart_row;

typedef struct chart_scene {
    const char *path;
    char name[SHAPE_NAME_MAX + 1];
    shape_set *set;
    shape_view view;
    shape_light light;
    double sun_angle; /* of the reference, degrees */
    double side;      /* longest, of all clouds [m] */
    char digest[CHART_DIGEST + 1];
    float *reference; /* radiance */
    double noise2;    /* what its noise adds to a relMSE on average */
    chart_row *rows;
    size_t row_count;
} chart_scene;

typedef struct chart_plan {
    const char *folder;
    chart_scene *scenes;
    size_t scene_count;
    int runs;
    double noise; /* of the references */
    uint64_t seed;
    bool quick;
    double start;      /* seconds, chart_seconds() */
    double limit;      /* seconds that all may take; 0: any */
    shape_error no_gl; /* why there is no OpenGL; its text is "" where there is */
} chart_plan;

/* --- chart_base.c --- */

/* Of a clock that only goes forward. */
double chart_seconds(void);
/* The first bytes of the SHA-256, in hexadecimal. */
void chart_digest(const void *bytes, size_t size, char digest[CHART_DIGEST + 1]);
/* DIR/name; the caller frees it. */
char *chart_path(const chart_plan *plan, const char *name);

/* --- chart_measure.c --- */

/* The scene's rows: every setting that makes a difference on it. */
void chart_rows_make(const chart_plan *plan, chart_scene *scene);
/* Measures what is not measured yet, and writes results.csv after each measurement. */
void chart_measure(chart_plan *plan);

/* --- chart_reference.c --- */

/* Reads the scene's reference from the folder, or traces it and writes it there. */
void chart_reference(const chart_plan *plan, chart_scene *scene, double deadline);

/* --- chart_gl.c --- */

typedef struct chart_gl chart_gl;
shape_status chart_gl_open(chart_gl **gl, shape_error *error);
void chart_gl_close(chart_gl *gl); /* NULL is allowed */
/* Forgets all renderers: before their volumes go. */
void chart_gl_forget(chart_gl *gl);
/* Draws by the renderer of that number (made on first use). times gets milliseconds; radiance may be NULL. */
shape_status chart_gl_draw(chart_gl *gl, size_t number, const chart_setting *setting,
                           const shape_volume *volume, const shape_view *view, const shape_light *light,
                           double times[CHART_KINDS], float *radiance, shape_error *error);

/* --- chart_front.c --- */

/* Median of its runs, milliseconds; negative: not measured. */
double chart_median(const chart_row *row, chart_kind kind);
/* Marks the rows that no other beats in both time and error. */
void chart_front_mark(chart_scene *scene, chart_kind kind);
/* The fastest row with a relMSE of at most that; NULL: none. */
const chart_row *chart_front_pick(const chart_scene *scene, chart_kind kind, double relmse);
/* The row of least error; NULL where nothing is measured. */
const chart_row *chart_front_best(const chart_scene *scene, chart_kind kind);
/* What the reference's noise hides: no relMSE below it can be told. */
double chart_relmse_least(const chart_scene *scene);

/* --- chart_results.c --- */

/* Takes over what results.csv in the folder has of these scenes. Ends the program where it is no such file. */
void chart_results_read(chart_plan *plan);
void chart_results_write(const chart_plan *plan);

/* --- chart_series.c --- */

/* Measures and draws --appendix: series.csv, series.svg, series.png. */
void chart_series(const chart_plan *plan, const chart_scene *scene);

/* --- chart_write.c: chart.svg and chart.png by gnuplot; chart_report.c: report.md --- */

/* Draws by a script that `print` writes for that terminal, into a file of the folder. Ends the program where it fails. */
void chart_draw_script(const chart_plan *plan, const char *terminal, const char *name,
                       void (*print)(FILE *file, const void *context, const char *terminal),
                       const void *context);

/* Ends the program where gnuplot cannot be run. */
void chart_need_gnuplot(void);
void chart_draw(const chart_plan *plan);
void chart_report(const chart_plan *plan);

#endif
