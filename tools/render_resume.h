/* neph-render --resume: the reference's sums kept in a file while it works, and gone on with. */
#ifndef NEPHELE_RENDER_RESUME_H
#define NEPHELE_RENDER_RESUME_H

#include "cli.h"
#include "cli_scene.h"
#include "shape/mesh.h"
#include "shape/pathtrace.h"

extern const cli_option render_resume_options[];
/* The first of them that was given, or NULL. */
const char *render_resume_given(void);
/* Ends the program, exit 2, where they make no sense together. */
void render_resume_check(void);

/* A mesh that stands in the picture, with its place and colour; all are told before the work starts. */
void render_resume_note_mesh(const shape_mesh *mesh, const shape_frame *frame, const float albedo[3]);
void render_resume_note_ground(double height, const float albedo[3]);

/* Sets pixels, samples_before and keep of the options where --resume is given: from its file, if that is there. Ends the
 * program where the file is of another picture, damaged, or has more paths than options->samples. The other members of
 * options, view and light must have their values. */
void render_resume_start(const cli_input *input, const shape_view *view, const shape_light *light,
                         shape_pathtrace_options *options);
/* Writes the file for the last time; samples: of each pixel. Frees the sums. */
void render_resume_end(shape_pathtrace_options *options, int samples);

#endif
