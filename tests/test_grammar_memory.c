/* Grammars when memory runs out: each allocation of parsing and growing fails once, and is reported as such. The
 * address sanitizer, where it is on, finds what would be left behind. */
#include "failing_memory.h"

#include "shape/turtle.h"

static const char text[] = "axiom X(1, 6)\niterations 7\npuffs F\n"
                           "X(r,n) : n > 0 -> F(r) [ +(20..40) X(r*0.8, n-1) ] @(1,2,1) F X(r, n-2) : 0.9\n"
                           "X(r,n) : n > 0 -> F";

static shape_status parse_and_grow(shape_error *error)
{
    static shape_mistakes mistakes;
    shape_grammar *grammar;
    shape_set *set = shape_set_create(error);
    shape_status status = set ? shape_set_add_cloud(set, "cloud", NULL, error) : SHAPE_ERROR_MEMORY;
    if (!status)
        status = shape_grammar_parse(text, strlen(text), "t", &grammar, &mistakes, error);
    if (!status) {
        shape_derive_options options = shape_derive_defaults(grammar);
        status = shape_grammar_grow(grammar, &options, shape_set_list(set, 0), NULL, error);
        shape_grammar_destroy(grammar);
    }
    shape_set_destroy(set);
    return status;
}

static void every_failed_allocation_is_an_error(void **state)
{
    (void)state;
    /* Cells, nodes, tokens, arguments, rules, levels, values, brackets, primitives, ... */
    fail_each(parse_and_grow, 10, 0);
}

static shape_status ignore(void *user, const shape_symbol *symbol, shape_error *error)
{
    (void)symbol, (void)error;
    ++*(long *)user;
    return SHAPE_OK;
}

static void memory_does_not_grow_with_the_string(void **state)
{
    (void)state;
    /* A string of 2^20 symbols is 20 levels deep. A level and its parameters take about a hundred bytes, an array
     * grows by a half, and starts with 16 elements: 16 KiB is far above that, and far below a byte a symbol. */
    static shape_mistakes mistakes;
    static const char doubling[] = "axiom x(1)\nx(n) -> x(n) x(n)\niterations 20";
    shape_grammar *grammar;
    shape_error error;
    long seen = 0;
    assert_int_equal(shape_grammar_parse(doubling, strlen(doubling), "t", &grammar, &mistakes, &error),
                     SHAPE_OK);
    shape_derive_options options = shape_derive_defaults(grammar);
    most = 0;
    assert_int_equal(shape_grammar_derive(grammar, &options, ignore, &seen, NULL, &error), SHAPE_OK);
    assert_int_equal(seen, 1 << 20);
    assert_true(most > 0 && most < 16384);
    shape_grammar_destroy(grammar);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_failed_allocation_is_an_error),
        cmocka_unit_test(memory_does_not_grow_with_the_string),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
