/* Grammars: parsing, mistakes with their places, derivation, limits, chance. The turtle is test_turtle.c's. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

#include "shape/grammar.h"

static shape_mistakes mistakes;

static shape_grammar *parse(const char *text)
{
    shape_grammar *grammar = NULL;
    shape_error error;
    if (shape_grammar_parse(text, strlen(text), "t", &grammar, &mistakes, &error))
        fail_msg("%s\n%s", error.text, text);
    return grammar;
}

/* --- derived strings --- */

typedef struct text {
    char bytes[4096];
    size_t used;
} text;

static shape_status write_symbol(void *user, const shape_symbol *s, shape_error *error)
{
    text *t = user;
    (void)error;
    assert_true(t->used + 512 < sizeof t->bytes);
    t->bytes[t->used++] = s->letter;
    for (int i = 0; i < s->argument_count; i++)
        t->used += (size_t)snprintf(t->bytes + t->used, 64, "%c%.9g", i ? ',' : '(', s->arguments[i]);
    if (s->argument_count)
        t->bytes[t->used++] = ')';
    t->bytes[t->used] = 0;
    return SHAPE_OK;
}

static const char *derive(const char *grammar_text, int iterations, uint64_t seed)
{
    static text result;
    result.used = 0;
    result.bytes[0] = 0;
    shape_grammar *grammar = parse(grammar_text);
    shape_derive_options options = shape_derive_defaults(grammar);
    shape_error error;
    options.seed = seed;
    if (iterations >= 0)
        options.iterations = iterations;
    if (shape_grammar_derive(grammar, &options, write_symbol, &result, NULL, &error))
        fail_msg("%s", error.text);
    shape_grammar_destroy(grammar);
    return result.bytes;
}

static shape_derive_counts count(const char *grammar_text, int iterations)
{
    shape_grammar *grammar = parse(grammar_text);
    shape_derive_options options = shape_derive_defaults(grammar);
    shape_derive_counts counts = {0, 0};
    shape_error error;
    if (iterations >= 0)
        options.iterations = iterations;
    if (shape_grammar_derive(grammar, &options, NULL, NULL, &counts, &error))
        fail_msg("%s", error.text);
    shape_grammar_destroy(grammar);
    return counts;
}

static void paper_grammar_has_128_spheres(void **state)
{
    (void)state;
    /* Jiménez 2018, Eq. 18: every X and every Y becomes two puffs, so 2^7; one turn between any two of them. */
    const char *forms[] = {"axiom X\niterations 7\nX -> X + Y\nY -> X & Y\n",
                           "iterations 7\nAxiom \u2192 X\nX \u2192 X + Y\nY \u2192 X & Y",
                           "\xef\xbb\xbfiterations 7\r\nAxiom ::= X\r\nX ::= X+Y\r\nY ::= X&Y\r\n"};
    for (int i = 0; i < 3; i++) {
        shape_derive_counts counts = count(forms[i], -1);
        assert_int_equal(counts.primitives, 128);
        assert_int_equal(counts.symbols, 255);
    }
    assert_string_equal(derive(forms[0], 3, 1), "X+Y+X&Y+X+Y&X&Y");
}

static void algae_grow_as_fibonacci(void **state)
{
    (void)state;
    /* Lindenmayer's algae (Prusinkiewicz and Lindenmayer 1990, p. 3): lengths are Fibonacci numbers. */
    const char *algae = "axiom A\nA -> AB\nB -> A";
    assert_string_equal(derive(algae, 4, 1), "ABAABABA");
    uint64_t a = 1, b = 2;
    for (int n = 0; n < 25; n++) {
        assert_int_equal(count(algae, n).symbols, a);
        uint64_t next = a + b;
        a = b;
        b = next;
    }
}

static void parameters_conditions_and_expressions(void **state)
{
    (void)state;
    /* The parametric example of Prusinkiewicz and Lindenmayer 1990, Eq. 1.7, its first five words. */
    const char *book = "axiom B(2)A(4,4)\n"
                       "A(x,y) : y <= 3 -> A(x*2, x+y)\n"
                       "A(x,y) : y > 3 -> B(x)A(x/y, 0)\n"
                       "B(x) : x < 1 -> C\n"
                       "B(x) : x >= 1 -> B(x-1)\n";
    const char *words[] = {"B(2)A(4,4)", "B(1)B(4)A(1,0)", "B(0)B(3)A(2,1)", "CB(2)A(4,3)", "CB(1)A(8,7)"};
    for (int n = 0; n < 5; n++)
        assert_string_equal(derive(book, n, 1), words[n]);
    static const struct {
        const char *expression;
        double value;
    } cases[] = {{"1+2*3", 7},
                 {"(1+2)*3", 9},
                 {"2^3^2", 512},
                 {"-2^2", -4},
                 {"2^-1", 0.5},
                 {"10-4-3", 3},
                 {"100/10/5", 2},
                 {"7 % 3 + mod(-1, 3)", 3},
                 {"1 < 2 && 2 <= 2 && 3 > 2 && 3 >= 3 && 1 != 2 && 1 == 1", 1},
                 {"0 && 1/0 || !0", 1},
                 {"1 || 1/0", 1},
                 {"min(3, 2) + max(3, 2)*10", 32},
                 {"abs(-3) + sqrt(16) + floor(2.9) + ceil(2.1) + round(2.5)", 15},
                 {"sin(30) + cos(60)", 1},
                 {"log(exp(2))", 2},
                 {"(0-1)^65 + (0-1)^66", 0},
                 {"(0-1.5)^65 / 1.5^65", -1},
                 {".5 + 5e-1 + 1.e0", 2},
                 {"0.1", 0.1},
                 {"123456789012345678901234567890e-29", 1.2345678901234567890}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char grammar[256];
        snprintf(grammar, sizeof grammar, "axiom m(%s)", cases[i].expression);
        double value = atof(derive(grammar, 0, 1) + 2);
        if (!(fabs(value - cases[i].value) <= 1e-8 * fabs(cases[i].value))) /* nine digits are printed */
            fail_msg("%s is %.9g, not %.9g", cases[i].expression, value, cases[i].value);
    }
}

static void bodies_lines_and_comments(void **state)
{
    (void)state;
    assert_string_equal(derive("axiom a \\\n b # c \\\nx -> y # \u00e4", 1, 1), "ab");
    assert_string_equal(derive("axiom a\\b", 0, 1), "a\\b");
    assert_string_equal(derive("axiom ab\na -> *\nb -> c", 1, 1), "c");
    assert_string_equal(derive("axiom X iterations 2 angle 3\nX->XY", -1, 1), "XYY");
    assert_string_equal(derive("axiom +(1)-(2)&^\\/|[!(2)]@(1,2,3)", 0, 1), "+(1)-(2)&^\\/|[!(2)]@(1,2,3)");
}

static void settings_are_taken(void **state)
{
    (void)state;
    shape_grammar *g =
        parse("axiom X\nradius 1.5  length 0.5..2\nshrink 0.8..1.0 angle -10..20 puffs X Yz\n"
              "extinction 3 albedo 0.9 phase two-lobe g 0.5 g2 -0.25 lobe-mix 0.125 droplet 20\n"
              "model metaball kappa 0.75 octaves 3 noise-scale 0.5 edge 2 stretch 1,2,0.5 iterations 9");
    const shape_grammar_settings *s = shape_grammar_get_settings(g);
    assert_true(s->iterations == 9 && s->radius.low == 1.5 && s->radius.high == 1.5);
    assert_true(s->length.low == 0.5 && s->length.high == 2 && s->shrink.low == 0.8 && s->shrink.high == 1);
    assert_true(s->angle.low == -10 && s->angle.high == 20 && s->stretch[1] == 2 && s->stretch[2] == 0.5);
    assert_true(s->medium.extinction == 3 && s->medium.albedo == 0.9f &&
                s->medium.phase == SHAPE_PHASE_TWO_LOBE);
    assert_true(s->medium.g == 0.5f && s->medium.g2 == -0.25f && s->medium.lobe_mix == 0.125f);
    assert_true(s->medium.droplet == 20 && s->field.model == SHAPE_MODEL_METABALL && s->field.kappa == 0.75f);
    assert_true(s->field.octaves == 3 && s->field.noise_scale == 0.5f && s->field.edge == 2);
    assert_true(shape_grammar_is_puff(g, 'X') && shape_grammar_is_puff(g, 'z') &&
                !shape_grammar_is_puff(g, 'A'));
    shape_grammar_destroy(g);
    g = parse("axiom X");
    assert_true(shape_grammar_is_puff(g, 'A') && !shape_grammar_is_puff(g, 'G') &&
                !shape_grammar_is_puff(g, 'a'));
    assert_int_equal(shape_grammar_get_settings(g)->iterations, 5);
    assert_true(shape_grammar_get_settings(g)->angle.low == 25);
    shape_grammar_destroy(g);
}

/* --- chance --- */

static void weights_are_frequencies(void **state)
{
    (void)state;
    /* N independent draws with probability p: the count lies within 4 standard errors of N p. The weights 1.4 and 0.6
     * are of one symbol, so they stand for 0.7 and 0.3; the condition that never holds takes no part. */
    enum { N = 20000 };
    const char *grammar = "axiom a(20000)\npuffs X\na(n) : n > 0 -> Y a(n-1)\nY -> X : 1.4\nY -> x : 0.6\n"
                          "Y : 1 > 2 -> XX : 50\niterations 20002";
    double found = (double)count(grammar, -1).primitives;
    double error = sqrt(N * 0.7 * 0.3);
    assert_true(fabs(found - N * 0.7) < 4 * error);
    assert_int_equal(count("axiom XX\npuffs Z\nX -> Z : 0\nX -> *", 1).symbols, 0);
    assert_int_equal(count("axiom XX\nX -> Z : 0", 1).symbols, 2); /* nothing to choose: it stays */
}

static shape_status sum_arguments(void *user, const shape_symbol *s, shape_error *error)
{
    double *sums = user;
    (void)error;
    for (int i = 0; i < s->argument_count; i++) {
        assert_true(s->arguments[i] >= 2 && s->arguments[i] < 4);
        sums[0] += 1;
        sums[1] += s->arguments[i];
        sums[2] += s->arguments[i] * s->arguments[i];
    }
    return SHAPE_OK;
}

static void ranges_are_uniform(void **state)
{
    (void)state;
    enum { N = 10000 };
    shape_grammar *g = parse("axiom a\na -> m(2..4, rand(2,4)) a\niterations 10000");
    shape_derive_options options = shape_derive_defaults(g);
    double sums[3] = {0, 0, 0};
    shape_error error;
    assert_int_equal(shape_grammar_derive(g, &options, sum_arguments, sums, NULL, &error), SHAPE_OK);
    double n = sums[0], mean = sums[1] / n, variance = sums[2] / n - mean * mean;
    assert_true(n == 2.0 * N);
    /* Uniform in [2, 4]: mean 3, variance 1/3; the variance of a square of it is (1/5 - 1/9). */
    assert_true(fabs(mean - 3) < 4 * sqrt(1.0 / 3 / n));
    assert_true(fabs(variance - 1.0 / 3) < 4 * sqrt((1.0 / 5 - 1.0 / 9) / n));
    shape_grammar_destroy(g);
}

static void choices_do_not_depend_on_other_branches(void **state)
{
    (void)state;
    const char *rules =
        "\nX -> AX : 0.5\nX -> BX : 0.5\nY -> C : 0.5\nY -> DDD(rand(1,2)) : 0.5\niterations 8";
    char one[256], two[256], first[512], second[512];
    snprintf(one, sizeof one, "axiom YX%s", rules);
    snprintf(two, sizeof two, "axiom yX%s", rules);
    snprintf(first, sizeof first, "%s", derive(one, -1, 7));
    snprintf(second, sizeof second, "%s", derive(two, -1, 7));
    assert_string_equal(strpbrk(first, "AB"), strpbrk(second, "AB"));
    /* More levels go on where fewer ended. */
    snprintf(first, sizeof first, "%s", derive(two, 5, 7));
    assert_memory_equal(first, second, strlen(first) - 1);
    /* The seed matters, and nothing else does. */
    assert_string_equal(second, derive(two, -1, 7));
    int different = 0;
    for (uint64_t seed = 1; seed <= 8; seed++)
        different += strcmp(second, derive(two, -1, seed)) != 0;
    assert_true(different >= 5); /* eight strings of eight fair draws are hardly ever alike */
}

static shape_status check_scale(void *user, const shape_symbol *s, shape_error *error)
{
    int *seen = user;
    (void)error;
    double low = s->letter == 'a'   ? 1
                 : s->letter == 'b' ? 0.5
                                    : 0.125,
           high = s->letter == 'c' ? 0.42875 : 0.75;
    if (s->letter == 'a')
        assert_true(s->scale == 1);
    else
        assert_true(s->scale >= low && s->scale < high);
    seen[s->letter - 'a']++;
    return SHAPE_OK;
}

static void shrink_multiplies_for_each_rule(void **state)
{
    (void)state;
    /* a: no rule; b: one; c: three; each factor lies in [0.5, 0.75), and 0.75^3 is 0.421875. */
    shape_grammar *g = parse("axiom aX\nX -> bY\nY -> Z\nZ -> c\nshrink 0.5..0.75");
    shape_derive_options options = shape_derive_defaults(g);
    shape_error error;
    int seen[3] = {0, 0, 0};
    for (options.seed = 1; options.seed <= 50; options.seed++)
        assert_int_equal(shape_grammar_derive(g, &options, check_scale, seen, NULL, &error), SHAPE_OK);
    assert_true(seen[0] == 50 && seen[1] == 50 && seen[2] == 50);
    shape_grammar_destroy(g);
}

/* --- limits --- */

static void expect_end(const char *grammar, uint64_t max_primitives, shape_status status, const char *part)
{
    shape_grammar *g = parse(grammar);
    shape_derive_options options = shape_derive_defaults(g);
    shape_error error = {SHAPE_OK, ""};
    options.max_primitives = max_primitives;
    clock_t start = clock();
    assert_int_equal(shape_grammar_derive(g, &options, NULL, NULL, NULL, &error), status);
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    if (!strstr(error.text, part))
        fail_msg("\"%s\" does not say \"%s\"", error.text, part);
    assert_true(seconds < 1); /* optimised it takes a tenth or two; the bound holds with sanitizers as well */
    shape_grammar_destroy(g);
}

static void runaways_end_quickly(void **state)
{
    (void)state;
    expect_end("axiom X\niterations 100000\nX -> X X", 100000, SHAPE_ERROR_LIMIT,
               "t:3:6: more than 100000 primitives");
    expect_end("axiom x\niterations 60\nx -> x x", 10, SHAPE_ERROR_LIMIT, "t:3:6: more than 1000000 symbols");
    expect_end("axiom x\niterations 60\nx -> y y\ny -> x x\n", 10, SHAPE_ERROR_LIMIT, "symbols");
    expect_end("axiom xx\niterations 100000\nx -> [x]x", 10, SHAPE_ERROR_LIMIT, "symbols");
}

static void depth_is_no_recursion(void **state)
{
    (void)state;
    shape_derive_counts counts = count("axiom x\niterations 100000\nx -> F[x]", -1);
    assert_int_equal(counts.primitives, 100000);
    assert_int_equal(counts.symbols, 300001);
}

static void failures_while_deriving_name_their_place(void **state)
{
    (void)state;
    expect_end("axiom x(3)\niterations 9\nx(n) -> m(1/n) x(n-1)", 9, SHAPE_ERROR_FORMAT,
               "t:3:12: division by zero");
    expect_end("axiom x(1)\nx(n) : sqrt(0-n) > 1 -> y", 9, SHAPE_ERROR_FORMAT, "t:2:8: the square root");
    expect_end("axiom x(1)\nx(n) -> y : 0-n", 9, SHAPE_ERROR_FORMAT, "t:2:14: the probability is -1");
    expect_end("axiom x(1)\nx(n) -> y(2..n)", 9, SHAPE_ERROR_FORMAT, "t:2:12: the range runs backwards");
    expect_end("axiom x(2)\niterations 2000\nx(n) -> x(n^9)", 9, SHAPE_ERROR_FORMAT,
               "t:3:12: the result is too large");
    expect_end("axiom x(0)\nx(n) -> m(3 % n)", 9, SHAPE_ERROR_FORMAT, "t:2:13: mod by zero");
    expect_end("axiom x(-8)\nx(n) -> m(n^0.5)", 9, SHAPE_ERROR_FORMAT, "t:2:12: a broken power");
    expect_end("axiom x(0)\nx(n) -> m(log(n))", 9, SHAPE_ERROR_FORMAT, "t:2:11: the logarithm");
    expect_end("axiom x(2e9)\nx(n) -> m(sin(n))", 9, SHAPE_ERROR_FORMAT, "t:2:11: an angle beyond");
}

/* --- mistakes --- */

typedef struct expected {
    int line, column;
    const char *part;
} expected;

static void expect_mistakes(const char *grammar, const expected *list, int number)
{
    shape_grammar *g = NULL;
    shape_error error;
    assert_int_equal(shape_grammar_parse(grammar, strlen(grammar), "t", &g, &mistakes, &error),
                     SHAPE_ERROR_FORMAT);
    assert_null(g);
    for (int i = 0; i < number && i < mistakes.count; i++) {
        const shape_mistake *m = &mistakes.items[i];
        if (m->line != list[i].line || m->column != list[i].column || !strstr(m->text, list[i].part))
            fail_msg("%d:%d: %s; expected %d:%d: %s, in\n%s", m->line, m->column, m->text, list[i].line,
                     list[i].column, list[i].part, grammar);
    }
    if (mistakes.count != number)
        fail_msg("%d mistakes, expected %d, in\n%s", mistakes.count, number, grammar);
}

#define EXPECT(grammar, ...)                                                                                 \
    do {                                                                                                     \
        const expected list[] = {__VA_ARGS__};                                                               \
        expect_mistakes(grammar, list, (int)(sizeof list / sizeof *list));                                   \
    } while (0)

static void mistakes_in_settings(void **state)
{
    (void)state;
    EXPECT("axiom X\niteratons 3", {2, 1, "did you mean iterations?"});
    EXPECT("axium X", {1, 1, "did you mean axiom?"});
    EXPECT("iterations 2", {1, 1, "there is no axiom"});
    EXPECT("axiom", {1, 1, "the axiom is empty"});
    EXPECT("axiom X\naxiom Y", {2, 1, "a second axiom (the first is in line 1"});
    EXPECT("axiom X\nradius 1 length 2 radius 3", {2, 19, "radius is set twice (first in line 2"});
    EXPECT("axiom X\nangle 12x", {2, 7, "angle 12x"});
    EXPECT("axiom X\nangle nan length inf", {2, 7, "angle nan"}, {2, 18, "length inf"});
    EXPECT("axiom X\nangle 3..", {2, 7, "angle 3.."});
    EXPECT("axiom X\nangle 30..10", {2, 7, "runs backwards (write 10..30)"});
    EXPECT("axiom X\niterations 2.5 octaves 17", {2, 12, "whole number"}, {2, 24, "out of range"});
    EXPECT("axiom X\nradius 0 shrink", {2, 8, "radius 0: out of range"}, {2, 16, "shrink has no value"});
    EXPECT("axiom X\nmodel spheriod phase x", {2, 7, "did you mean spheroid?"}, {2, 22, "write one of hg"});
    EXPECT("axiom X\npuffs", {2, 1, "puffs has no letters"});
    EXPECT("axiom X\npuffs X +", {2, 9, "'+' cannot be a puff"});
    EXPECT("axiom X\nstretch 1,2", {2, 9, "has 2 numbers"});
    EXPECT("axiom X\n7 radius 1", {2, 1, "where a setting or a rule should begin"});
    EXPECT("axiom X\nangle 1e999", {2, 7, "too large"});
}

static void mistakes_in_rules(void **state)
{
    (void)state;
    EXPECT("axiom X\nX ->", {2, 3, "nothing behind the arrow"});
    EXPECT("axiom X\nX -> : 0.5", {2, 3, "nothing behind the arrow"});
    EXPECT("axiom X\n-> X", {2, 1, "nothing before the arrow"});
    EXPECT("axiom X\nXY -> X", {2, 1, "XY before the arrow"});
    EXPECT("axiom X\n+ -> X", {2, 1, "only a letter"});
    EXPECT("axiom X\nX X + Y", {2, 1, "without an arrow"});
    EXPECT("axiom X\nX -> [X", {2, 6, "'[' is not closed"});
    EXPECT("axiom X\nX -> [[X]", {2, 6, "'[' is not closed"});
    EXPECT("axiom X]\nX -> X][", {1, 8, "']' without '['"}, {2, 7, "']' without '['"},
           {2, 8, "'[' is not closed"});
    EXPECT("axiom X\nX -> X : -1", {2, 10, "negative"});
    EXPECT("axiom X\nX -> X : 0.5 0.5", {2, 14, "behind the probability"});
    EXPECT("axiom X\nX -> F 2", {2, 8, "a number among the symbols"});
    EXPECT("axiom X\nX -> F -> F", {2, 9, "a second arrow"});
    EXPECT("axiom X\nX -> (F)", {2, 6, "without a symbol"});
    EXPECT("axiom X\nX -> \u00e4 \u2212 F $", {2, 6, "is not a symbol"}, {2, 8, "write '-'"},
           {2, 12, "'$' is not"});
    EXPECT("axiom X(1)\nX(r -> F(r)", {2, 2, "'(' is not closed"});
    EXPECT("axiom X(1,1)\nX(r,r) -> F(r)", {2, 5, "two parameters"});
    EXPECT("axiom X\nX(r) -> F(r)\nX -> X(1,2)", {1, 7, "X has 0 arguments"},
           {3, 1, "X has 0 parameters here"}, {3, 6, "X has 2 arguments"});
    EXPECT("axiom F(1,2,3)G(1,2)+(1,2)|(1)[(1)]", {1, 7, "takes two"}, {1, 15, "it takes one"},
           {1, 21, "it takes one"}, {1, 27, "no argument"}, {1, 31, "no argument"});
    EXPECT("axiom X : 1", {1, 9, "behind the axiom"});
    EXPECT("axiom X\nX -> F)", {2, 7, "')' without '('"});
    EXPECT("axiom X(1)\nX(1) -> F", {2, 3, "where a parameter's name should stand"});
    EXPECT("axiom X(1)\nX(a b) -> F", {2, 5, "write ',' or ')'"});
}

static void mistakes_in_expressions(void **state)
{
    (void)state;
    EXPECT("axiom X(1)\nX(r) -> F(q)", {2, 11, "q is not a parameter (those of X: r)"});
    EXPECT("axiom F(r)", {1, 9, "the axiom has none"});
    EXPECT("axiom F(1+)", {1, 11, "')' where a number should stand"});
    EXPECT("axiom F(1", {1, 8, "'(' is not closed"});
    EXPECT("axiom F(1 2)", {1, 11, "'2' is not expected"});
    EXPECT("axiom F(2r)", {1, 10, "directly behind a number"});
    EXPECT("axiom F(foo(1)) F(sqr(1)) F(min(1)) F((2)", {1, 9, "foo is not a function"},
           {1, 19, "did you mean sqrt?"}, {1, 29, "min has 1 argument (it takes 2)"},
           {1, 38, "'(' is not closed"});
    EXPECT("axiom F(1/0) F(sqrt(-1)) F(3..1)", {1, 10, "division by zero"}, {1, 16, "square root"},
           {1, 28, "runs backwards (write 1..3)"});
    EXPECT("axiom X(1)\nX(n) : n = 1 -> F\nX(n) : 1 < n < 3 -> F\nX(n) : n & 1 -> F | F", {2, 10, "write =="},
           {3, 14, "a second comparison"}, {4, 10, "write &&"});
    EXPECT("axiom X(1)\nX(n) : n | 1 -> F", {2, 10, "write ||"});
    EXPECT("axiom X(1)\nX(n) : n > -> F", {2, 12, "where a number should stand"});
}

static void bytes_and_characters(void **state)
{
    (void)state;
    /* Columns count characters: each umlaut in the comment is two bytes; bad bytes are named wherever they stand. */
    EXPECT("axiom X # \u00e4\u00f6\xff\n\x01X -> X", {1, 13, "not UTF-8"},
           {2, 1, "control character, U+0001"});
    EXPECT("axiom X\nX -> X \\\n   $", {3, 4, "'$' is not"});
    char *large = malloc(SHAPE_GRAMMAR_TEXT_MAX + 1);
    assert_non_null(large);
    memset(large, ' ', SHAPE_GRAMMAR_TEXT_MAX + 1);
    shape_grammar *g;
    shape_error error;
    assert_int_equal(shape_grammar_parse(large, SHAPE_GRAMMAR_TEXT_MAX + 1, "t", &g, &mistakes, &error),
                     SHAPE_ERROR_LIMIT);
    free(large);
}

static void nested_and_long_expressions_are_bounded(void **state)
{
    (void)state;
    static char deep[40000];
    size_t used = (size_t)snprintf(deep, sizeof deep, "axiom F(");
    memset(deep + used, '(', 10000);
    memcpy(deep + used + 10000, "1)", 3);
    shape_grammar *g;
    shape_error error;
    assert_int_equal(shape_grammar_parse(deep, strlen(deep), "t", &g, &mistakes, &error), SHAPE_ERROR_FORMAT);
    assert_non_null(strstr(mistakes.items[0].text, "nested deeper"));
    for (size_t i = 0; i < 10000; i++)
        memcpy(deep + used + 2 * i, "1+", 2);
    memcpy(deep + used + 20000, "1)", 3);
    assert_int_equal(shape_grammar_parse(deep, strlen(deep), "t", &g, &mistakes, &error), SHAPE_ERROR_FORMAT);
    assert_non_null(strstr(mistakes.items[0].text, "operators in a row"));
}

static void mistakes_are_capped(void **state)
{
    (void)state;
    char many[1000] = "axiom X\n";
    for (int i = 0; i < 60; i++)
        strcat(many, "foo 1\n");
    shape_grammar *g;
    shape_error error;
    assert_int_equal(shape_grammar_parse(many, strlen(many), "t", &g, &mistakes, &error), SHAPE_ERROR_FORMAT);
    assert_int_equal(mistakes.count, SHAPE_GRAMMAR_MISTAKES_MAX);
    assert_true(mistakes.more);
    assert_string_equal(error.text,
                        "t:2:1: foo is not a setting (write a setting's name, or a rule X -> ...)");
}

static void options_are_checked(void **state)
{
    (void)state;
    shape_grammar *g = parse("axiom X");
    shape_derive_options good = shape_derive_defaults(g), o;
    shape_error error;
    assert_int_equal(shape_derive_check(&good, &error), SHAPE_OK);
    const char *names[] = {"iterations", "angle", "radius", "length", "shrink", "max-primitives"};
    for (int i = 0; i < 6; i++) {
        o = good;
        if (i == 0)
            o.iterations = -1;
        if (i == 1)
            o.angle.high = NAN;
        if (i == 2)
            o.radius.low = 0;
        if (i == 3)
            o.length.low = 2; /* above high */
        if (i == 4)
            o.shrink.high = 1e9;
        if (i == 5)
            o.max_primitives = 0;
        assert_int_equal(shape_grammar_derive(g, &o, NULL, NULL, NULL, &error), SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, names[i]));
    }
    shape_grammar_destroy(g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paper_grammar_has_128_spheres),
        cmocka_unit_test(algae_grow_as_fibonacci),
        cmocka_unit_test(parameters_conditions_and_expressions),
        cmocka_unit_test(bodies_lines_and_comments),
        cmocka_unit_test(settings_are_taken),
        cmocka_unit_test(weights_are_frequencies),
        cmocka_unit_test(ranges_are_uniform),
        cmocka_unit_test(choices_do_not_depend_on_other_branches),
        cmocka_unit_test(shrink_multiplies_for_each_rule),
        cmocka_unit_test(runaways_end_quickly),
        cmocka_unit_test(depth_is_no_recursion),
        cmocka_unit_test(failures_while_deriving_name_their_place),
        cmocka_unit_test(mistakes_in_settings),
        cmocka_unit_test(mistakes_in_rules),
        cmocka_unit_test(mistakes_in_expressions),
        cmocka_unit_test(bytes_and_characters),
        cmocka_unit_test(nested_and_long_expressions_are_bounded),
        cmocka_unit_test(mistakes_are_capped),
        cmocka_unit_test(options_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
