/* Grammars letter by letter: characters of every length and the bytes that are none, numbers, words, operators with their
 * values, and mistakes at the edges of each. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shape/turtle.h"

static shape_mistakes mistakes;

/* Each text has a mistake that says these words. */
static void refuse_bytes(const char *text, size_t size, const char *words)
{
    shape_grammar *grammar = NULL;
    shape_error error = {.text = ""};
    if (shape_grammar_parse(text, size, "t", &grammar, &mistakes, &error) != SHAPE_ERROR_FORMAT)
        fail_msg("taken: %s", text);
    assert_null(grammar);
    bool said = false;
    for (int i = 0; i < mistakes.count; i++)
        said = said || strstr(mistakes.items[i].text, words);
    if (!said)
        fail_msg("%d mistakes, the first \"%s\"; none says \"%s\", in\n%s", mistakes.count,
                 mistakes.items[0].text, words, text);
}

static void refuse(const char *text, const char *words)
{
    refuse_bytes(text, strlen(text), words);
}

static shape_grammar *parse(const char *text)
{
    shape_grammar *grammar = NULL;
    shape_error error;
    if (shape_grammar_parse(text, strlen(text), "t", &grammar, &mistakes, &error))
        fail_msg("%s, in\n%s", error.text, text);
    return grammar;
}

static shape_status keep_argument(void *user, const shape_symbol *symbol, shape_error *error)
{
    (void)error;
    if (symbol->argument_count)
        *(double *)user = symbol->arguments[0];
    return SHAPE_OK;
}

static shape_status evaluate(const char *expression, double *value, shape_error *error)
{
    char text[1024];
    snprintf(text, sizeof text, "axiom x(0)\niterations 1\nx(n) -> m(%s)", expression);
    shape_grammar *grammar = parse(text);
    shape_derive_options options = shape_derive_defaults(grammar);
    *value = NAN;
    shape_status status = shape_grammar_derive(grammar, &options, keep_argument, value, NULL, error);
    shape_grammar_destroy(grammar);
    return status;
}

static void test_values(void **state)
{
    (void)state;
    static const struct {
        const char *expression;
        double value;
    } cases[] = {{"min(1,2)", 1},
                 {"min(2,1)", 1},
                 {"max(1,2)", 2},
                 {"max(2,1)", 2},
                 {"!0", 1},
                 {"!3", 0},
                 {"!n", 1},
                 {"+2", 2},
                 {"-2", -2},
                 {"n == 0", 1},
                 {"n == 1", 0},
                 {"n != 0", 0},
                 {"n != 1", 1},
                 {"n <= 0", 1},
                 {"n >= 1", 0},
                 {"n < 1", 1},
                 {"n > 1", 0},
                 {"1 || n", 1},
                 {"n || 2", 1},
                 {"n || n", 0},
                 {"1 && n", 0},
                 {"n && 1", 0},
                 {"2 && 3", 1},
                 {"(-2)^3", -8},
                 {"(-2)^70", 0x1p70},
                 {"(-2)^71", -0x1p71},
                 {"(-2)^(-70)", 0x1p-70},
                 {"7 % 4", 3},
                 {"mod(7,4)", 3},
                 {"1e2", 100},
                 {"1E+2", 100},
                 {"1e-2", 0.01},
                 {".5", 0.5},
                 {"0.5", 0.5},
                 {"1 .. 1", 1},
                 {"n..n", 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double value;
        shape_error error;
        if (evaluate(cases[i].expression, &value, &error))
            fail_msg("%s: %s", cases[i].expression, error.text);
        if (!(fabs(value - cases[i].value) <= 1e-12 * fabs(cases[i].value)))
            fail_msg("%s is %.17g, not %.17g", cases[i].expression, value, cases[i].value);
    }
}

/* What only shows while the grammar grows, also within an operator or a function. */
static void test_failed_values(void **state)
{
    (void)state;
    static const struct {
        const char *expression, *words;
    } cases[] = {{"1/n", "division by zero"},       {"1 && 1/n", "division by zero"},
                 {"n || 1/n", "division by zero"},  {"1/n || 1", "division by zero"},
                 {"2 + 1/n", "division by zero"},   {"max(1, 1/n)", "division by zero"},
                 {"n + 1 .. n", "runs backwards"},  {"(n-2)^0.5", "broken power"},
                 {"1e308 * (10 + n)", "too large"}, {"sqrt(n - 1)", "square root"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double value;
        shape_error error = {.text = ""};
        assert_int_equal(evaluate(cases[i].expression, &value, &error), SHAPE_ERROR_FORMAT);
        if (!strstr(error.text, cases[i].words))
            fail_msg("%s: \"%s\" does not say \"%s\"", cases[i].expression, error.text, cases[i].words);
    }
}

static void test_mistakes_in_expressions(void **state)
{
    (void)state;
    static const struct {
        const char *expression, *words;
    } cases[] = {{"min(1)", "min has 1 argument (it takes 2)"},
                 {"abs(1,2)", "abs has 2 arguments (it takes 1)"},
                 {"min(1,2,3)", "min has 3 arguments (it takes 2)"},
                 {"min(1,)", "where a number should stand"},
                 {"min(1 2)", "is not expected here"},
                 {"(1 2)", "is not expected here"},
                 {"(1", "'(' is not closed"},
                 {"()", "where a number should stand"},
                 {"-", "where a number should stand"},
                 {"!", "where a number should stand"},
                 {"1 + ", "where a number should stand"},
                 {"1 * *", "where a number should stand"},
                 {"1 = 2", "write =="},
                 {"1 ! 2", "is not expected here"},
                 {"2x", "directly behind a number"},
                 {"2_", "directly behind a number"},
                 {"1e", "directly behind a number"},
                 {"1e+", "directly behind a number"},
                 {"2..1", "runs backwards"},
                 {"1..", "where a number should stand"},
                 {"..1", "where a number should stand"},
                 {"q", "q is not a parameter (those of x: n)"},
                 {"sqr(2)", "did you mean sqrt?"},
                 {"zzz(2)", "is not a function (there are"},
                 {"1e400", "too large"},
                 {"1e99999999999", "too large"},
                 {"\xc2\xa0", "a space that is not a plain one"},
                 {"\xe2\x80\xaf", "a space that is not a plain one"},
                 {"\xe2\x80\x89", "a space that is not a plain one"},
                 {"\xc3\xa9", "'\xc3\xa9' where a number"},
                 {"\xe2\x82\xac", "'\xe2\x82\xac' where a number"},
                 {"\xf0\x9f\x98\x80", "'\xf0\x9f\x98\x80' where a number"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "axiom x(0)\nx(n) -> m(%s)", cases[i].expression);
        refuse(text, cases[i].words);
    }
    refuse("axiom x(q)\nx(n) -> m", "q is not a parameter (the axiom has none");
    refuse("axiom x\nx -> m(q)", "q is not a parameter (x has none");
    refuse("axiom x(1,2)\nx(a,b) -> m(q)", "those of x: a, b");
    char digits[600];
    snprintf(digits, sizeof digits, "axiom x(0)\nx(n) -> m(%0401d)", 1);
    refuse(digits, "a number of 401 digits");
    snprintf(digits, sizeof digits, "axiom x(0)\nx(n) -> m(%0399d)", 1);
    shape_grammar_destroy(parse(digits));
}

/* Bytes that are not UTF-8 (RFC 3629), and the nearest that are. */
static void test_bytes(void **state)
{
    (void)state;
    static const char *const wrong[] = {
        "\x80",         "\xbf",         "\xc1\xbf",        "\xf5\x80\x80\x80", "\xc3",
        "\xe2\x82",     "\xc3(",        "\xe2\x28\xa1",    "\xe0\x9f\xbf",     "\xf0\x8f\xbf\xbf",
        "\xed\xa0\x80", "\xed\xbf\xbf", "\xf4\x90\x80\x80"};
    static const char *const right[] = {"\xc2\x80",         "\xdf\xbf",        "\xe0\xa0\x80",
                                        "\xed\x9f\xbf",     "\xee\x80\x80",    "\xef\xbf\xbd",
                                        "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"};
    char text[64];
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(text, sizeof text, "axiom x # %s", wrong[i]);
        refuse(text, "a byte that is not UTF-8");
        snprintf(text, sizeof text, "axiom x %s\n", wrong[i]);
        refuse(text, "a byte that is not UTF-8");
    }
    for (size_t i = 0; i < sizeof right / sizeof *right; i++) {
        snprintf(text, sizeof text, "axiom x # %s", right[i]);
        shape_grammar_destroy(parse(text));
    }
    refuse("axiom x \x01", "U+0001");
    refuse("axiom x \x7f", "U+007F");
    refuse("axiom x # \x1f", "U+001F");
    shape_grammar_destroy(parse("\xef\xbb\xbf"
                                "axiom x\r\n\titerations 2 \\  \t\r\n  angle 3 # \\\n"));
    refuse_bytes("\xef\xbb", 2, "a byte that is not UTF-8");
    refuse("axiom x \\ y -> z\\", "a rule"); /* a backslash before something turns; one at the end goes on */
}

/* Settings: values that are none, are too many, or are cut off, each alone and with another setting behind it. */
static void test_settings(void **state)
{
    (void)state;
    static const struct {
        const char *setting, *words;
    } cases[] = {{"angle", "angle has no value"},
                 {"angle x", "angle x: not a number or a range"},
                 {"angle 1..", "angle 1..: not a number"},
                 {"angle 1.5.2", "angle 1.5.2: not a number"},
                 {"angle 1.2..3..4", "not a number"},
                 {"angle 3..1", "runs backwards"},

                 {"angle +", "angle +: not a number"},
                 {"angle -x", "angle -x: not a number"},
                 {"angle \xc3\xa9", "angle ?: not a number"},
                 {"angle 2e6", "out of range"},
                 {"iterations 1.5", "not a whole number"},
                 {"iterations -1", "out of range"},
                 {"iterations", "iterations has no value"},
                 {"kappa 2", "out of range"},
                 {"kappa x", "not a number"},
                 {"kappa", "kappa has no value"},
                 {"stretch 1", "stretch has 1 number (write three"},
                 {"stretch 1,2", "stretch has 2 numbers (write three"},
                 {"stretch 1,2,", "not three numbers"},
                 {"stretch", "stretch has no value"},
                 {"model", "model has no value"},
                 {"model uniforn", "did you mean uniform?"},
                 {"model 7", "not known"},
                 {"model uniform!", "not known"},
                 {"phase zzzzzzzzz", "write one of hg, isotropic"},
                 {"puffs", "puffs has no letters"},
                 {"puffs 1", "cannot be a puff"},
                 {"puffs \xc3\xa9", "cannot be a puff"},
                 {"axiom = y", "'=' behind axiom"},
                 {"axiom", "the axiom is empty"},
                 {"axiom y", "a second axiom"},
                 {"axiom y : 0.5", "behind the axiom"},
                 {"angel 3", "did you mean angle?"},
                 {"Q", "a rule without an arrow (write Q -> ...)"},
                 {"q (3)", "a rule without an arrow (write q -> ...)"},
                 {"q : 3", "a rule without an arrow"},
                 {"zzzzzzzzzzzz 3", "is not a setting (write a setting's name"},
                 {"radius 1 radius 2", "radius"},
                 {"? 3", "where a setting or a rule should begin"},
                 {"? angle", "angle has no value"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "axiom x\n%s", cases[i].setting);
        refuse(text, cases[i].words);
        snprintf(text, sizeof text, "axiom x\n%s\niterations x", cases[i].setting);
        refuse(text, "iterations x: not a whole number"); /* the mistake behind it is found, too */
    }
    refuse("iteratons 3\nangle 3", "axiom");
    refuse("Axioms x", "did you mean axiom?");
    shape_grammar *grammar =
        parse("AXIOM x\nmodel uniform phase two-lobe\tpuffs x,Y stretch 1,2,3 angle -1..+2 g -0.5");
    const shape_grammar_settings *settings = shape_grammar_get_settings(grammar);
    assert_int_equal(settings->field.model, SHAPE_MODEL_UNIFORM);
    assert_int_equal(settings->medium.phase, SHAPE_PHASE_TWO_LOBE);
    assert_true(settings->stretch[2] == 3 && settings->angle.low == -1 && settings->angle.high == 2);
    assert_true(shape_grammar_is_puff(grammar, 'x') && shape_grammar_is_puff(grammar, 'Y'));
    assert_false(shape_grammar_is_puff(grammar, 'Z'));
    shape_grammar_destroy(grammar);
    char word[300];
    memset(word, 'a', sizeof word);
    memcpy(word, "axiom x\n", 8);
    word[299] = 0;
    refuse(word, "aaaa"); /* a name far longer than any is cut */
    memcpy(word, "axiom x\nangle ", 14);
    refuse(word, "not a number");
}

/* Rules and symbols. */
static void test_rules(void **state)
{
    (void)state;
    static const struct {
        const char *rule, *words;
    } cases[] = {{"x -> @(1)", "@"},
                 {"x -> @(1,2)", "@"},
                 {"x -> !(1,2,3)", "!"},
                 {"x -> y > z", "a second arrow"},
                 {"x -> y \xe2\x88\x92 z", "\xe2\x88\x92"},
                 {"x -> y \xe2\x80\x93 z", "\xe2\x80\x93"},
                 {"x -> y \xe2\x80\x94 z", "\xe2\x80\x94"},
                 {"x -> * y", "a symbol behind"},
                 {"x -> \xce\xb5 y", "a symbol behind"},
                 {"x -> y : -1", "-1"},
                 {"x -> y : q", "q is not a parameter"},
                 {"x(a) -> y\nx(a,b) -> z", "2"},
                 {"x(a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p,q) -> y", "parameter"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "axiom x\n%s", cases[i].rule);
        refuse(text, cases[i].words);
    }
    shape_grammar_destroy(parse("axiom x\nx -> * : 0.5\nx -> \xce\xb5 : 0.5"));
    shape_grammar_destroy(parse("axiom x\nx ::= y"));
}

/* --- growing --- */

static shape_status grow(const char *text, shape_error *error)
{
    shape_grammar *grammar = parse(text);
    shape_set *set = shape_set_create(error);
    assert_non_null(set);
    assert_int_equal(shape_set_add_cloud(set, "a", NULL, error), SHAPE_OK);
    shape_derive_options options = shape_derive_defaults(grammar);
    shape_status status = shape_grammar_grow(grammar, &options, shape_set_list(set, 0), NULL, error);
    shape_set_destroy(set);
    shape_grammar_destroy(grammar);
    return status;
}

static void test_turtle_ends(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {{"axiom F(0)", "radius"},
                 {"axiom F(1e10)", "radius"},
                 {"axiom !(1,-1)", "factor on the length"},
                 {"axiom !(0)", "factor on the radius"},
                 {"axiom @(1e7,1,1) F", "1e"},
                 {"axiom @(0,1,1) F", "1e"},
                 {"axiom G(1e30) F", "the distance from the origin"},
                 {"axiom &(90) G(1e10)", "the distance from the origin"},
                 {"axiom &(90) +(90) G(1e10)", "the distance from the origin"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shape_error error = {.text = ""};
        if (!grow(cases[i].text, &error))
            fail_msg("%s grows", cases[i].text);
        if (!strstr(error.text, cases[i].words))
            fail_msg("%s: \"%s\" does not say \"%s\"", cases[i].text, error.text, cases[i].words);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_values),
                                       cmocka_unit_test(test_failed_values),
                                       cmocka_unit_test(test_mistakes_in_expressions),
                                       cmocka_unit_test(test_bytes),
                                       cmocka_unit_test(test_settings),
                                       cmocka_unit_test(test_rules),
                                       cmocka_unit_test(test_turtle_ends)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
