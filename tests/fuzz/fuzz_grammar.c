/* Fuzzes grammars: any text is refused with mistakes that have a place in it, or it is derived within small limits
 * into primitives that a set accepts. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shape/neph.h"
#include "shape/turtle.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void must(int truth)
{
    if (!truth)
        abort();
}

static void check_mistakes(const shape_mistakes *mistakes, size_t size)
{
    must(mistakes->count > 0);
    for (int i = 0; i < mistakes->count; i++) {
        const shape_mistake *m = &mistakes->items[i];
        must(m->line >= 1 && m->column >= 1 && (size_t)m->line <= size + 1 && (size_t)m->column <= size + 1);
        must(m->text[0] && !strchr(m->text, '\n'));
        must(!i || m[-1].line < m->line || (m[-1].line == m->line && m[-1].column <= m->column));
    }
}

/* Most inputs are derived a little, so that many can be; one of 64, by its own bytes, is derived far. */
static void grow(const shape_grammar *grammar, bool far)
{
    shape_error error = {SHAPE_OK, ""};
    shape_derive_counts counts;
    shape_derive_options options = shape_derive_defaults(grammar);
    must(!shape_derive_check(&options, &error)); /* the parser lets nothing through that is out of range */
    options.max_primitives = far ? 1000 : 60;
    options.max_symbols = far ? 20000 : 300;
    shape_set *set = shape_set_create(&error);
    must(set && !shape_set_add_cloud(set, "fuzz", NULL, &error));
    if (shape_grammar_grow(grammar, &options, shape_set_list(set, 0), &counts, &error))
        must(error.text[0] != 0);
    else
        must(counts.primitives == shape_primitives_count(shape_set_list(set, 0)));
    set->clouds[0].field = shape_grammar_get_settings(grammar)->field;
    set->clouds[0].medium = shape_grammar_get_settings(grammar)->medium;
    must(!shape_cloud_choose_noise_scale(&set->clouds[0], shape_set_list(set, 0), &error));
    must(!shape_set_check(set, &error));
    shape_set_destroy(set);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static shape_mistakes mistakes;
    shape_error error;
    shape_grammar *grammar;
    shape_status status = shape_grammar_parse(data, size, "fuzz", &grammar, &mistakes, &error);
    if (status) {
        must(status == SHAPE_ERROR_FORMAT && error.text[0]);
        check_mistakes(&mistakes, size);
        return 0;
    }
    grow(grammar, shape_crc32(data, size) % 64 == 0);
    shape_grammar_destroy(grammar);
    return 0;
}
