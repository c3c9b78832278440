/* pitviper_settings.h: settings: YAML files with validated keys, by a table; and the lists that tables are made of. */
#ifndef PITVIPER_SETTINGS_H
#define PITVIPER_SETTINGS_H

#include "pitviper.h"

typedef enum SettingType {
    SETTING_DOUBLE,
    SETTING_INT,
    SETTING_LONG /* long long */,
    SETTING_BOOL,
    SETTING_TEXT /* char[] */,
    SETTING_SWITCH /* bool; its words are on and off */,
    SETTING_CHOICE,  /* an enum, whose values are the places of their words in `choices`, from 0 */
    SETTING_WORDS,   /* char[]: words separated by commas, blanks around them dropped; in YAML a list too */
    SETTING_NUMBERS, /* NumberList; in YAML a list of numbers, or of lists of numbers, which become one row */
    /* char[], the names of files. In a file of settings they are relative to that file's folder, on a command line to
     * the current one: after reading, *out has usable paths. */
    SETTING_PATH,
    SETTING_PATHS,         /* several, separated by commas; in YAML a list too */
    SETTING_NAME_OR_PATH,  /* a path has a dot or a slash in it; a name is kept unchanged */
    SETTING_NAME_OR_PATHS, /* the same, of one name or several paths */
    /* Read by the table's own function, in files alone; choices: what is accepted, for messages */
    SETTING_OWN,  /* one text; a list is its words with blanks between */
    SETTING_EACH, /* one text, or a list of them: one call each */
    SETTING_MAP,  /* `key: text` with free keys: one call each */
} SettingType;

enum { number_list_capacity = 256 };
typedef struct NumberList {
    int    count;
    double number[number_list_capacity];
} NumberList;

/* One key of a struct. SETTING_AT(Config, sensor.width_px) gives offset and size. */
typedef struct Setting {
    const char *name; /* `section.key`, or `key` at the top level */
    SettingType type;
    size_t      offset, size;
    double      low, high; /* range of each number; low NaN: any finite number */
    const char
        *choices; /* of a switch or a choice: its words, separated by `|`. For SETTING_OWN: see there. Else NULL */
    const char *unit, *help;
} Setting;
typedef struct SettingValue {
    const char *key, *text; /* key: that of an entry of a map; else NULL */
    int         line;
    bool        wrong_key; /* set by the reader when the key is wrong, not the text */
} SettingValue;
/* STATUS_BAD_VALUE: logged as "'text' is not <choices>", or with a complaint as "'text' is <complaint>". */
typedef Status SettingOwn(const char **complaint, void *out, const Setting *row, SettingValue *value);
#define SETTING_AT(type, member) offsetof(type, member), sizeof(((type *)0)->member)

/* A section that is a list of mappings, `vehicles: [{...}, {...}]`: each fills one item. */
typedef struct SettingTable SettingTable;
typedef struct SettingList {
    const char         *name;
    const SettingTable *item;
    void *(*add)(void *owner); /* a new item with its defaults; NULL: there are too many */
} SettingList;

struct SettingTable {
    const char        *module; /* prefix of the messages: `config` */
    const Setting     *row;
    int                count;
    const SettingList *list; /* NULL: none */
    int                list_count;
    size_t             line_at;  /* offset in an item of an int that gets the line where it starts; 0: none */
    const char        *all_keys; /* the command that prints them: `pitviper check --default`; NULL: none */
    const char        *prefix;   /* prefix of its keys in messages, `joints.`; NULL: none */
    SettingOwn        *own;      /* reads rows of SETTING_OWN, _EACH and _MAP */
};

enum { settings_file_octets = 1 << 20 };

/* Whether a text is safe to parse with libyaml: 32 levels, 256 anchors, 8 directives, no NUL, one document, YAML from
 * end to end. Time in proportion to octets; logs what is wrong, with its line. */
Status yaml_check(const char *module, const char *path, const char *text, size_t octets);

/* Overwrites *out. Absent keys keep their values; what is unknown, given twice, of the wrong kind or out of range
 * is STATUS_BAD_VALUE with file, line, key, value and the accepted range in one logged line; each of them, up to 50.
 * given[row], may be NULL, is set for each key at the top level. On failure *out is half filled: read into a copy. */
Status settings_read(void *out, bool *given, const SettingTable *table, const char *path);
/* The same from memory; path is for the messages. */
Status settings_parse(void *out, bool *given, const SettingTable *table, const char *path, const char *text,
                      size_t octets);
/* As settings_read; paths in it are relative to the folder of another file, which need not exist. */
Status settings_read_as(void *out, bool *given, const SettingTable *table, const char *path, const char *file);
/* One key from a command line; source: its option, `--size`. On failure *out is unchanged. */
Status settings_set(void *out, bool *given, const SettingTable *table, const char *name, const char *value,
                    const char *source);
/* The same as if it were in that file, for paths relative to the file's folder. file NULL: as settings_set. */
Status settings_set_from(void *out, bool *given, const SettingTable *table, const char *name, const char *value,
                         const char *source, const char *file);
/* Whether each path is of a regular file, of a folder, or of nothing that is there; else logged: a FIFO or a device
 * would be waited for. outputs: names of keys, `a.b,c.d`, that may be of anything. */
bool settings_paths_good(const void *from, const SettingTable *table, const char *outputs);
/* Paths become absolute, as far as they fit: for files in other folders, and for hashes. */
void settings_absolute(void *out, const SettingTable *table);
/* Line of a key in a file that was read; 0: absent. */
int settings_line(const SettingTable *table, const char *name, const char *path);
int settings_find(const SettingTable *table, const char *name); /* row; -1: no such key */
/* Every key and value, in table order, one per line: the input of the hash. */
void settings_text(char *out, size_t out_size, const SettingTable *table, const void *from);
/* A file that reads back as *from: sections, each key with its help, unit and range as a comment. Keys for which
 * shown (may be NULL) is false, and those that are unset (NaN), are commented out. */
void settings_write(FILE *to, const SettingTable *table, const void *from, const bool *shown);
/* Every key with its accepted values and its help. */
void settings_write_keys(FILE *to, const SettingTable *table);

/* ---- rows: one entry states a setting ---------------------------------------------------------- */

/* The settings of a struct are a list, a macro with an entry for each: kind, section with its dot (or nothing), key,
 * which is the name of the member too, default, what its kind needs, help.
 *
 *     #define BOX_ROWS(ROW)                                                                                      \
 *         ROW(DOUBLE, lid., weight_kg, 1.5, 0, 10, "kg", "of the lid")                                           \
 *         ROW(CHOICE, , paint, BOX_RED, BoxPaint, (BOX_BLUE, "blue")(BOX_RED, "red"), "its colour")
 *
 *     DOUBLE, INT, LONG, NUMBERS           low, high, unit, help        NUMBERS: the default is {0}
 *     BOOL                                 help
 *     SWITCH                               words, help                  "on|off" or "off|on"
 *     CHOICE                               tag, words, help             makes `enum tag`, a value for each word
 *     TEXT                                 size, unit, help
 *     WORDS, PATH, PATHS, NAME_OR_PATH, NAME_OR_PATHS     size, help
 *
 * All else is made of it: members, BOX_ROWS(SETTING_MEMBER) in a struct; initializers, {BOX_ROWS(SETTING_DEFAULT)}; and
 * the table, with `#define BOX_ROW(...) SETTING_ROW(Box, __VA_ARGS__)`: static const Setting keys[] =
 * {BOX_ROWS(BOX_ROW)}. A section is a struct in the struct, with a list of its own. */

/* clang-format off */
#define SETTING_MEMBER(kind, ...)                         SETTING_MEMBER_##kind(__VA_ARGS__)
#define SETTING_MEMBER_DOUBLE(section, key, ...)          double key;
#define SETTING_MEMBER_INT(section, key, ...)             int key;
#define SETTING_MEMBER_LONG(section, key, ...)            long long key;
#define SETTING_MEMBER_NUMBERS(section, key, ...)         NumberList key;
#define SETTING_MEMBER_BOOL(section, key, ...)            bool key;
#define SETTING_MEMBER_SWITCH(section, key, ...)          bool key;
#define SETTING_MEMBER_TEXT(section, key, value, size, ...) char key[size];
#define SETTING_MEMBER_WORDS                              SETTING_MEMBER_TEXT
#define SETTING_MEMBER_PATH                               SETTING_MEMBER_TEXT
#define SETTING_MEMBER_PATHS                              SETTING_MEMBER_TEXT
#define SETTING_MEMBER_NAME_OR_PATH                       SETTING_MEMBER_TEXT
#define SETTING_MEMBER_NAME_OR_PATHS                      SETTING_MEMBER_TEXT
#define SETTING_MEMBER_CHOICE(section, key, value, tag, words, help) enum tag { SETTING_EACH(VALUE, words) } key;

#define SETTING_DEFAULT(kind, section, key, value, ...)   .section key = value,

#define SETTING_ROW(owner, kind, ...)                     SETTING_ROW_##kind(SETTING_##kind, owner, __VA_ARGS__)
#define SETTING_ROW_DOUBLE(type, owner, section, key, value, low, high, unit, help) \
    {#section #key, type, SETTING_AT(owner, section key), low, high, NULL, unit, help},
#define SETTING_ROW_INT                                   SETTING_ROW_DOUBLE
#define SETTING_ROW_LONG                                  SETTING_ROW_DOUBLE
#define SETTING_ROW_NUMBERS                               SETTING_ROW_DOUBLE
#define SETTING_ROW_BOOL(type, owner, section, key, value, help) \
    SETTING_ROW_DOUBLE(type, owner, section, key, value, 0, 1, "", help)
#define SETTING_ROW_TEXT(type, owner, section, key, value, size, unit, help) \
    SETTING_ROW_DOUBLE(type, owner, section, key, value, 0, 0, unit, help)
#define SETTING_ROW_WORDS(type, owner, section, key, value, size, help) \
    SETTING_ROW_DOUBLE(type, owner, section, key, value, 0, 0, "", help)
#define SETTING_ROW_PATH                                  SETTING_ROW_WORDS
#define SETTING_ROW_PATHS                                 SETTING_ROW_WORDS
#define SETTING_ROW_NAME_OR_PATH                          SETTING_ROW_WORDS
#define SETTING_ROW_NAME_OR_PATHS                         SETTING_ROW_WORDS
#define SETTING_ROW_SWITCH(type, owner, section, key, value, words, help) \
    {#section #key, type, SETTING_AT(owner, section key), 0, 0, words, "", help},
#define SETTING_ROW_CHOICE(type, owner, section, key, value, tag, words, help) \
    {#section #key, type, SETTING_AT(owner, section key), 0, 0, &SETTING_EACH(WORD, words)[1], "", help},

/* SETTING_EACH(VALUE, (A, "a")(B, "b")): A, B, and with WORD "|a" "|b": each pair leaves the name of the macro that
 * takes the next, A and B by turns, since none takes its own result. */
#define SETTING_EACH(what, pairs)                         SETTING_END(SETTING_##what##_A pairs)
#define SETTING_END(...)                                  SETTING_END_(__VA_ARGS__)
#define SETTING_END_(...)                                 __VA_ARGS__##_END
#define SETTING_VALUE_A(value, word)                      value, SETTING_VALUE_B
#define SETTING_VALUE_B(value, word)                      value, SETTING_VALUE_A
#define SETTING_VALUE_A_END
#define SETTING_VALUE_B_END
#define SETTING_WORD_A(value, word)                       "|" word SETTING_WORD_B
#define SETTING_WORD_B(value, word)                       "|" word SETTING_WORD_A
#define SETTING_WORD_A_END
#define SETTING_WORD_B_END
/* clang-format on */

#endif
