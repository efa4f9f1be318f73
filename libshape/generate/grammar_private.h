/* Private to generate/grammar*.c, expression.c, derive.c and turtle.c: a grammar as data, and its parser's parts.
 * Bodies, arguments and expressions lie in arrays of the grammar and name each other by index. */
#ifndef SHAPE_GENERATE_GRAMMAR_PRIVATE_H
#define SHAPE_GENERATE_GRAMMAR_PRIVATE_H

#include "shape/grammar.h"
#include "shape/random.h"

enum { ARROW = 0x2192 }; /* U+2192, which stands for -> */
enum { NO_NODE = -1, NO_RULE = -1, NAME_ROOM = 32, LETTERS = 128, GRAMMAR_SETTINGS_MAX = 32 };

typedef struct place {
    int line, column;
} place;

/* --- the grammar as data --- */

typedef enum node_kind {
    NODE_NUMBER,
    NODE_PARAMETER, /* the index-th of the rule's parameters */
    NODE_NEGATE,
    NODE_NOT,
    NODE_ADD,
    NODE_SUBTRACT,
    NODE_MULTIPLY,
    NODE_DIVIDE,
    NODE_POWER,
    NODE_LESS,
    NODE_LESS_EQUAL,
    NODE_GREATER,
    NODE_GREATER_EQUAL,
    NODE_EQUAL,
    NODE_UNEQUAL,
    NODE_AND,
    NODE_OR,
    NODE_RANGE, /* A..B and rand(A,B): drawn at each evaluation */
    NODE_MIN,
    NODE_MAX,
    NODE_MOD,
    NODE_ABS,
    NODE_SQRT,
    NODE_FLOOR,
    NODE_CEIL,
    NODE_ROUND,
    NODE_EXP,
    NODE_LOG,
    NODE_SIN,
    NODE_COS
} node_kind;

typedef struct node {
    node_kind kind;
    int left, right; /* NO_NODE where there is none; the index of a parameter is in left */
    int height;      /* of the tree below, so that evaluation recurses to a known depth */
    bool constant;   /* nothing below is drawn or a parameter */
    double value;
    place at;
} node;

/* A symbol of a body with its arguments: argument_count nodes from grammar->arguments[first_argument]. */
typedef struct token {
    char letter;
    int argument_count;
    int first_argument;
    place at;
} token;

typedef struct body {
    int first, count; /* in grammar->tokens */
} body;

typedef struct rule {
    char letter;
    int parameter_count;   /* -1 after a mistake */
    int condition, weight; /* nodes, or NO_NODE: always, 1 */
    body body;
    int next; /* the letter's next rule in the text, or NO_RULE */
    place at;
} rule;

struct shape_grammar {
    char *name;
    shape_grammar_settings settings;
    bool puffs[LETTERS];
    body axiom;
    int first_rule[LETTERS];
    rule *rules;
    token *tokens;
    int *arguments;
    node *nodes;
    size_t rule_count, token_count, argument_count, node_count;
    size_t rule_capacity, token_capacity, argument_capacity, node_capacity;
};

/* --- evaluation (expression.c) --- */

/* What an evaluation needs, and what it says when it fails. The stream is seeded at the first draw. */
typedef struct evaluation {
    const shape_grammar *grammar;
    const double *parameters;
    uint64_t key, stream;
    bool seeded;
    shape_random random;
    place at;            /* of what has no value */
    const char *problem; /* "what (what to do)"; static */
} evaluation;

/* The value of a node; false, with at and problem filled, where there is none (division by zero, overflow, ...). */
bool grammar_evaluate(evaluation *e, int index, double *value);

/* --- parsing --- */

/* A character and its place. '\n' ends a statement, 0 the text. */
typedef struct cell {
    uint32_t c;
    place at;
} cell;

typedef struct parser {
    shape_grammar *grammar;
    shape_mistakes *mistakes;
    cell *cells;
    size_t cell_count, cell_capacity;
    size_t next,
        end; /* the statement at hand, or the part of it that is being read; cells[end] can be read */
    char parameters[SHAPE_GRAMMAR_ARGUMENTS_MAX][NAME_ROOM];
    int parameter_count;
    char letter;        /* whose rule is read; 0 in the axiom */
    bool any_parameter; /* the rule's own names are not known, after a mistake: take every name */
    bool has_axiom, axiom_misspelt;
    place axiom_at;
    int setting_lines[GRAMMAR_SETTINGS_MAX]; /* where each was set; 0: not yet */
    int nesting;                             /* of the expression being read */
    bool out_of_memory;
} parser;

/* grammar_lex.c: characters, words, numbers, mistakes. */
void grammar_lex(parser *p, const unsigned char *text, size_t size);
void grammar_mistake(parser *p, place at, const char *format, ...) SHAPE_PRINTF(3, 4);
uint32_t grammar_peek(const parser *p, size_t ahead); /* 0 beyond the end */
place grammar_here(const parser *p);
void grammar_skip_blanks(parser *p);
bool grammar_at_end(parser *p); /* after blanks */
bool grammar_is_letter(uint32_t c);
bool grammar_is_digit(uint32_t c);
/* The character as text for a message, in quotes, or words for what cannot be seen. */
const char *grammar_show(uint32_t c, char text[48]);
/* An unsigned decimal number at the cursor; what comes directly behind it is the caller's to check. */
bool grammar_number(parser *p, double *value);
/* Letters, digits, '_' and, where hyphens, '-' between them; cut to the room. False where no letter stands. */
bool grammar_word(parser *p, bool hyphens, char word[NAME_ROOM]);
/* The known word nearest to `word` within two changes, or NULL. names ends by NULL. */
const char *grammar_nearest(const char *word, const char *const *names);

/* expression.c: an expression at the cursor becomes a node; NO_NODE after a mistake, which is reported. */
int grammar_expression(parser *p);
/* The same, or a range A..B. */
int grammar_argument(parser *p);

/* grammar_table.c: whether a setting's name of at least two letters stands at the cursor as a word of its own. */
bool grammar_at_setting(const parser *p);

/* grammar_body.c */
/* Symbols up to the statement's end, a ':' or, with `stop`, a setting's name. */
void grammar_body(parser *p, bool stop, body *body);

/* grammar_rule.c */
/* The index of the statement's arrow and its length in cells; false where there is none. */
bool grammar_find_arrow(const parser *p, size_t *arrow, int *length);
void grammar_rule(parser *p, size_t arrow, int arrow_length);
/* Compares each use of a symbol with the number of parameters that its rules have. */
void grammar_check_uses(parser *p);

/* grammar_setting.c */
void grammar_settings_line(parser *p);
void grammar_axiom(parser *p, place at, bool stop);

#endif
