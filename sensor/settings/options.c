/* sensor/settings/options.c: the options of replay and run: their table, help and parsing, and how those of a sweep are
 * passed to its variants. */
#include "sensor/settings/options.h"

#include "pitviper_channels.h"
#include "sensor/settings/command_line.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

enum { IN_REPLAY = 1, IN_RUN = 2, IN_BOTH = 3 };
enum {
    OUT = 256,
    SIZE,
    HOST,
    CONFIG,
    SET,
    THREADS,
    SPEED,
    FOR,
    FRAMES,
    NO_SKIP,
    ISA,
    OVERWRITE,
    ONLY,
    SAVE,
    SWEEP,
    HELP,
    KEY
};

static const char *const names[] = {"replay", "run"};

/* In the order of the help. key: the setting that the option sets; with its value for an option without an argument.
 * Options that only change settings are passed to the variants of a sweep in their settings file (in_settings), all
 * others but the sweep's own (of_sweep) on their command lines. */
static const struct Row {
    const char *name;
    int         what, where;
    const char *key, *argument, *help;
} rows[] = {
    {"address", KEY, IN_RUN, "network.address", "ADDRESS",
     "numeric address of the exercise: multicast group, broadcast or host\n"
     "(default: receive on all, send to 255.255.255.255)"},
    {"address", KEY, IN_REPLAY, "network.address", "ADDRESS",
     "with --speed and publish.dis: where Data PDUs are sent, numeric\n(default: 255.255.255.255)"},
    {"interface", KEY, IN_BOTH, "network.interface", "NAME", "for example eth0 (default: the system's choice)"},
    {"port", KEY, IN_BOTH, "exercise.port", "N", "UDP port of the exercise (default: 3000)"},
    {"out", OUT, IN_BOTH, NULL, "DIR", "folder for the products (default: out)"},
    {"overwrite", OVERWRITE, IN_BOTH, NULL, NULL,
     "replace the products of an earlier run in DIR, or a recording of that\nname; without it that is an error"},
    {"bands", KEY, IN_BOTH, "sensor.bands", "LIST",
     "bands to render: any of optical,mwir,lwir,radar (default: all); swir in the place of optical"},
    {"size", SIZE, IN_BOTH, NULL, "WxH", "image size in pixels (default: 720x486)"},
    {"rate", KEY, IN_BOTH, "sensor.rate_hz", "HZ",
     "frames per second of exercise time (default: 5 for a munition, 1 for an\nobserver)"},
    {"from", KEY, IN_REPLAY, "exercise.from_s", "S", NULL},
    {"to", KEY, IN_REPLAY, "exercise.to_s", "S",
     "time span to render: exercise time in seconds as `pitviper inspect` shows\n"
     "it, or +12: after the start of the recording, -5: before its end; frames\n"
     "keep the numbers they have without a span"},
    {"only", ONLY, IN_REPLAY, NULL, "N,N,...",
     "render only these frames, by number; the same as in a full replay, except\n"
     "for the automatic level of display images (detector.agc_s)"},
    {"save-frame", SAVE, IN_REPLAY, NULL, "N,...",
     "save these frames to DIR/frame_NNNNNN.pvf, for `pitviper frame`, which\nre-renders one without the log"},
    {"host", HOST, IN_REPLAY, NULL, "ID",
     "entity that carries the sensor: site:application:entity, or observer; may\n"
     "be repeated; or once, munition: munitions in flight, guided ones first,\none after the other"},
    {"host", HOST, IN_RUN, NULL, "ID",
     "entity that carries the sensor, present now or later:\n"
     "site:application:entity; observer; munition: munitions as they appear,\n"
     "guided ones first, one after the other (default: chosen)"},
    {"samples", KEY, IN_BOTH, "sensor.samples", "N", "N x N rays per pixel (default: 1)"},
    {"config", CONFIG, IN_BOTH, NULL, "FILE", "or -c: a YAML file of settings; options override it"},
    {"set", SET, IN_BOTH, NULL, "KEY=VALUE", "one setting (`pitviper check --default` prints all); may be repeated"},
    {"threads", THREADS, IN_BOTH, NULL, "N", "number of threads (default: one per processor)"},
    {"seed", KEY, IN_BOTH, "seed", "N", "seed of all random numbers (default: 1)"},
    {"speed", SPEED, IN_REPLAY, NULL, "X", "exercise seconds per second, or max (default: max)"},
    {"cigi", KEY, IN_BOTH, "exercise.cigi", "HOST:PORT",
     "a CIGI 3.3 host gives each frame's time and eye, and waits for it"},
    {"fly", KEY, IN_BOTH, "flight.missile", "ROW",
     "fly a missile of this row of etc/missiles.csv from flight.from at\nexercise.aim, and send what others must know of it"},
    {"sight", KEY, IN_BOTH, "flight.sight", "WHAT",
     "what guides it: truth, recogniser, radar, operator (default: truth)"},
    {"head", KEY, IN_RUN, "exercise.head", "ADDRESS:PORT",
     "where a head tracker, or gamepad, says how the eye is turned"},
    {"head", KEY, IN_REPLAY, "exercise.head", "ADDRESS:PORT",
     "the eye is turned as the recording of `run --head` says"},
    {"causal", KEY, IN_REPLAY, "exercise.causal=true", NULL,
     "use only what had been received by the time of each frame and each\n"
     "choice: the frames of `pitviper run`, to the bit"},
    {"for", FOR, IN_RUN, NULL, "S", "stop after S seconds (default: never)"},
    {"frames", FRAMES, IN_RUN, NULL, "N", "stop after N frames (default: never)"},
    {"record", KEY, IN_RUN, "record.path", "LOG",
     "record all received datagrams to a pcapng file, for `replay --causal`"},
    {"no-skip", NO_SKIP, IN_BOTH, NULL, NULL, "disable skipping; same output, slower"},
    {"isa", ISA, IN_BOTH, NULL, "NAME", "instruction set of the ray tracer: avx2 (default), sse4.2, avx512"},
    {"no-png", KEY, IN_BOTH, "publish.png=false", NULL, "no display images, only EXR"},
    {"no-files", KEY, IN_BOTH, "publish.files=false", NULL, "no image files: only truth.jsonl and run.json"},
    {"planes", KEY, IN_BOTH, "publish.planes", "LIST",
     "truth planes to write: none, or any of range,entity,part,material,\n"
     "temperature,normal,emissivity,instance,cover (default: all); truth.jsonl is always written"},
    {"pairs", KEY, IN_REPLAY, "publish.pairs", "WHO",
     "target or all: each frame also without its target, or without any\nentity, and both without noise, in DIR/pairs"},
    {"coco", KEY, IN_REPLAY, "publish.coco=true", NULL, "DIR/coco.json: boxes and masks in COCO's format"},
    {"video", KEY, IN_BOTH, "publish.video", "PATH",
     "a file to play (.mp4, .mkv, .ts), all bands side by side; or a folder:\n"
     "per band a .ts with metadata and an .mp4"},
    {"stream", KEY, IN_BOTH, "publish.stream", "URL",
     "udp://HOST:PORT: live video with metadata (MPEG-TS), one port per band"},
    {"memory", KEY, IN_BOTH, "publish.memory", "NAME",
     "a ring of frames in shared memory, for a recogniser on this machine"},
    {"projector", KEY, IN_BOTH, "projector.band", "BAND", "one band on a display, the whole of it (projector.window)"},
    {"latest", KEY, IN_BOTH, "publish.latest=true", NULL, "DIR/latest/BAND.png: the newest display of each band"},
    {"sweep", SWEEP, IN_REPLAY, NULL, "FILE",
     "one run for each combination of the settings in a YAML file, in folders\n"
     "of DIR, with manifest.jsonl and manifest.html; resumes when repeated"},
    {"help", HELP, IN_BOTH, NULL, NULL, "print this help"},
};
enum { row_count = sizeof rows / sizeof rows[0] };

const char *options_command(const Options *o) { return names[o->command]; }

/* ---- help ------------------------------------------------------------------------------------ */

static void print_help(CommandName command)
{
    enum { column = 21 };
    static const char *const about[] = {
        "usage: pitviper replay LOG [options]\n"
        "\n"
        "Renders what a seeker sees in a recorded DIS exercise (pcap, pcapng): images per band, ground truth per "
        "pixel\n"
        "and per target. Needs no configuration; automatic choices are printed with the key that changes them. LOG "
        "may\n"
        "be compressed (gzip, zstd, bzip2, xz), or a pipe. When stopped by Ctrl-C (exit code 130), SIGTERM (143) or\n"
        "another signal N that would end it (128 + N) the frame is finished, and run.json says `stopped`. A video of a\n"
        "band, at --rate 5:\n"
        "    ffmpeg -framerate 5 -pattern_type glob -i 'out/frames/lwir/*.png' -pix_fmt yuv420p lwir.mp4\n\n",
        "usage: pitviper run [-c FILE] [options]\n"
        "\n"
        "Renders a live DIS exercise: a node that listens on UDP, makes its automatic choices from what it receives\n"
        "first (exercise.listen_s), and renders frames until it is stopped (Ctrl-C, SIGTERM, SIGUSR1). It sends nothing\n"
        "unless told to (--set publish.dis=sensor, or truth). A recording made with --record replays to the same images, to the bit.\n"
        "While there is no output the reason is reported, once each time it changes. Exit code 1 when no frame was\n"
        "rendered, or when nothing that was to be published could be sent or written; the reason is printed.\n\n"};
    fputs(about[command], stdout);
    for (int i = 0; i < row_count; i++) {
        const struct Row *row = &rows[i];
        char              left[40];
        if (!(row->where >> command & 1)) continue;
        snprintf(left, sizeof left, "  --%s%s%s%s", row->name, row->argument ? " " : "",
                 row->argument ? row->argument : "", row->help ? "" : ",");
        if (!row->help) { /* two options with one help text, on one line */
            printf("%s", left);
            continue;
        }
        const bool paired = i > 0 && !rows[i - 1].help && rows[i - 1].where == row->where;
        if (paired) printf("%-*s", column - (int)strlen("  --from S,"), left + 1);
        else printf("%-*s", column, left);
        for (const char *at = row->help; *at;) {
            const int n = (int)strcspn(at, "\n");
            printf("%*s%.*s\n", at == row->help ? 0 : column, "", n, at);
            at += n + (at[n] == '\n');
        }
    }
}

/* ---- one option ------------------------------------------------------------------------------ */

static bool set_size(Config *config, const char *text)
{
    char        width[16];
    const char *x = strchr(text, 'x');
    if (!x || x == text || x - text >= (long)sizeof width) {
        log_error("options: --size: '%s' is not WIDTHxHEIGHT, for example 720x486", text);
        return false;
    }
    memcpy(width, text, (size_t)(x - text));
    width[x - text] = 0;
    return config_set(config, "sensor.width_px", width, "--size") == STATUS_OK &&
           config_set(config, "sensor.height_px", x + 1, "--size") == STATUS_OK;
}

static bool set_pair(Config *config, const char *text, const char *source)
{
    char        key[64];
    const char *equals = strchr(text, '=');
    if (!equals || equals - text >= (long)sizeof key) {
        log_error("options: --set: '%s' is not KEY=VALUE, for example sensor.hfov_deg=3", text);
        return false;
    }
    memcpy(key, text, (size_t)(equals - text));
    key[equals - text] = 0;
    return config_set(config, key, equals + 1, source) == STATUS_OK;
}

static bool whole(int *out, const char *name, const char *text, long long low, long long high)
{
    long long  number;
    const bool ok = text_to_long(&number, text) && number >= low && number <= high;
    if (ok) *out = (int)number;
    else log_error("options: --%s: '%s' is not a whole number in %lld .. %lld", name, text, low, high);
    return ok;
}

static bool add_host(Options *o, const char *text)
{
    if (o->host_count == (o->command == COMMAND_RUN ? 1 : options_hosts_max)) {
        log_error(o->command == COMMAND_RUN ? "options: --host: a live node has %d; start another node for another host"
                                            : "options: --host: more than %d hosts",
                  o->host_count);
        return false;
    }
    o->host[o->host_count++] = text;
    return true;
}

static int compare_ints(const void *a, const void *b)
{
    const int x = *(const int *)a, y = *(const int *)b;
    return x < y ? -1 : x > y;
}

/* Parses a list of frames, such as 3,7,12, and sorts it without duplicates. */
static bool parse_frames(int out[options_only_max], int *out_count, const char *name, const char *text)
{
    char      one[16];
    long long number;
    int       count = 0;
    for (const char *at = text; at;) {
        const size_t length = strcspn(at, ",");
        snprintf(one, sizeof one, "%.*s", (int)(length < sizeof one ? length : sizeof one - 1), at);
        if (!text_to_long(&number, one) || number < 0 || number > 999999 || count == options_only_max) {
            log_error("options: --%s: '%s' is not a list of at most %d frame numbers in 0 .. 999999, for example "
                      "3,7,12",
                      name, text, options_only_max);
            return false;
        }
        out[count++] = (int)number;
        at = at[length] ? at + length + 1 : NULL;
    }
    qsort(out, (size_t)count, sizeof *out, compare_ints);
    *out_count = 1;
    for (int i = 1; i < count; i++)
        if (out[i] != out[*out_count - 1]) out[(*out_count)++] = out[i];
    return true;
}

static bool take(Options *o, const struct Row *row, const char *text)
{
    char source[24];
    bool ok = true;
    snprintf(source, sizeof source, "--%s", row->name);
    switch (row->what) {
    case KEY:
        if (!row->argument) return set_pair(&o->config, row->key, source);
        return config_set(&o->config, row->key, text, source) == STATUS_OK;
    case OUT:
        o->out = text;
        return true;
    case SIZE:
        return set_size(&o->config, text);
    case SET:
        return set_pair(&o->config, text, source);
    case HOST:
        return add_host(o, text);
    case THREADS:
        return whole(&o->threads, row->name, text, 1, 256);
    case FRAMES:
        return whole(&o->frames, row->name, text, 1, 1000000000);
    case SPEED:
        if (strcmp(text, "max") == 0) o->speed = INFINITY;
        else ok = text_to_double(&o->speed, text) && o->speed >= 1e-3 && o->speed <= 1e6;
        if (!ok) log_error("options: --speed: '%s' is neither `max` nor a number in 0.001 .. 1000000", text);
        return ok;
    case FOR:
        ok = text_to_double(&o->for_s, text) && o->for_s > 0 && o->for_s <= 1e8;
        if (!ok) log_error("options: --for: '%s' is not a number of seconds above 0, up to 1e8", text);
        return ok;
    case NO_SKIP:
        o->no_skip = true;
        return true;
    case ISA:
        ok = strcmp(text, "avx2") == 0 || strcmp(text, "sse4.2") == 0 || strcmp(text, "avx512") == 0;
        if (!ok) log_error("options: --isa: '%s' is not avx2, sse4.2 or avx512", text);
        o->isa = text;
        return ok;
    case ONLY:
        return parse_frames(o->only, &o->only_count, row->name, text);
    case SAVE:
        return parse_frames(o->save, &o->save_count, row->name, text);
    case SWEEP:
        o->sweep = text;
        return true;
    case OVERWRITE:
        o->overwrite = true;
        return true;
    default:
        return true; /* CONFIG has been read already */
    }
}

/* ---- a sweep's variants ---------------------------------------------------------------------- */

static bool in_settings(const struct Row *row)
{
    return row->what == KEY || row->what == SIZE || row->what == SET || row->what == CONFIG || row->what == HOST;
}

static bool of_sweep(const struct Row *row)
{
    return row->what == OUT || row->what == OVERWRITE || row->what == SWEEP || row->what == HELP;
}

/* Whether an option changes no product: a variant of a sweep made with another value of it is kept. */
static bool same_products(const struct Row *row)
{
    return row->what == THREADS || row->what == SPEED || row->what == NO_SKIP || row->what == ISA;
}

/* Notes an option for the command line of a variant: every one that neither changes only settings nor is the sweep's
 * own. */
static bool note_given(Options *o, const struct Row *row, const char *text)
{
    if (in_settings(row) || of_sweep(row)) return true;
    if (o->given_count == options_given_max) {
        log_error("options: --%s: too many options that are not settings: %d, at most %d", row->name,
                  options_given_max + 1, options_given_max);
        return false;
    }
    OptionGiven *given = &o->given[o->given_count++];
    *given = (OptionGiven){.argument = row->argument ? text : NULL, .same_products = same_products(row)};
    snprintf(given->flag, sizeof given->flag, "--%s", row->name);
    return true;
}

void options_variant(const char *argv[options_variant_argv], const Options *o, const char *settings, const char *out)
{
    const char *const fixed[] = {"pitviper", names[o->command], "--config", settings, "--out", out, "--overwrite"};
    int               n = 0;
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++) argv[n++] = fixed[i];
    for (int i = 0; i < o->given_count; i++) {
        argv[n++] = o->given[i].flag;
        if (o->given[i].argument) argv[n++] = o->given[i].argument;
    }
    argv[n++] = "--";
    argv[n++] = o->log;
    argv[n] = NULL;
}

/* ---- the command line -------------------------------------------------------------------------------- */

int options_count(void) { return row_count; }

bool options_option(const char **name, bool *argument, CommandName command, int i)
{
    *name = rows[i].name;
    *argument = rows[i].argument != NULL;
    return rows[i].where >> command & 1;
}

static void list_options(struct option list[row_count + 1], CommandName command)
{
    int n = 0;
    for (int i = 0; i < row_count; i++)
        if (rows[i].where >> command & 1)
            list[n++] = (struct option){rows[i].name, rows[i].argument != NULL, NULL, KEY + 1 + i};
    list[n] = (struct option){NULL, 0, NULL, 0};
}

static const struct Row *row_of(int option)
{
    for (int i = 0; option == 'c' && i < row_count; i++)
        if (rows[i].what == CONFIG) return &rows[i];
    return option > KEY ? &rows[option - KEY - 1] : NULL;
}

/* Reads the configuration file first, wherever it is on the command line: options override it. */
static Status read_config(Config *config, const struct option *list, int argc, char **argv)
{
    Status status = STATUS_OK;
    char **copy = calloc((size_t)argc + 1, sizeof *copy); /* getopt_long permutes its argument */
    if (!copy) return STATUS_NO_MEMORY;
    memcpy(copy, argv, (size_t)argc * sizeof *copy);
    optind = 0; /* restart getopt */
    opterr = 0; /* errors are reported by the pass over all options */
    for (int option; status == STATUS_OK && (option = getopt_long(argc, copy, "c:", list, NULL)) != -1;) {
        const struct Row *row = row_of(option);
        if (row && row->what == CONFIG) status = config_read(config, optarg);
    }
    free(copy);
    return status;
}

int options_parse(Options *o, CommandName command, int argc, char **argv)
{
    struct option list[row_count + 1];
    const char   *name = names[command];
    list_options(list, command);
    *o = (Options){.command = command,
                   .out = "out",
                   .isa = "avx2",
                   .threads = thread_processors(),
                   .speed = INFINITY,
                   .for_s = INFINITY,
                   .config = config_default()};
    const Status status = read_config(&o->config, list, argc, argv);
    if (status == STATUS_NO_MEMORY) log_error("%s: out of memory", name);
    if (status != STATUS_OK) return 1 + (status == STATUS_NO_MEMORY ? 1 : 2);
    optind = 0;
    for (int option; (option = command_line_option(argc, argv, "c:", list)) != -1;) {
        const struct Row *row = row_of(option); /* NULL: already reported by command_line_option */
        if (row && row->what == HELP) {
            print_help(command);
            return 1 + 0;
        }
        if (!row || !take(o, row, optarg) || !note_given(o, row, optarg)) return 1 + 2;
    }
    if (optind + (command == COMMAND_REPLAY) != argc) {
        if (command == COMMAND_RUN)
            return 1 + command_line_wrong(name,
                                          "'%s' is not an option; a live node takes no log, `pitviper replay` does",
                                          argv[optind]);
        if (optind == argc)
            return 1 + command_line_wrong(name, "no LOG is named: usage: pitviper replay LOG [options]");
        return 1 + command_line_wrong(name, "one LOG at a time, not also '%s'", argv[optind + 1]);
    }
    if (command == COMMAND_REPLAY) o->log = argv[optind];
    if (o->host_count == 1 && config_set(&o->config, "exercise.host", o->host[0], "--host") != STATUS_OK) return 1 + 2;
    if (o->host_count == 1) o->host_count = 0; /* a single host is kept as a setting */
    if (command == COMMAND_RUN && (o->config.publish.pairs != PUBLISH_PAIRS_OFF || o->config.publish.coco)) {
        log_error("options: publish.%s: only made by `replay`; use --record, then `replay --causal`",
                  o->config.publish.coco ? "coco" : "pairs");
        return 1 + 2;
    }
    if (channels_load() == STATUS_NO_MEMORY) return 1 + 1;
    if (o->sweep) return 0; /* its axes are settings too: combinations are checked for each variant */
    return config_check(&o->config) == STATUS_OK ? 0 : 1 + 2;
}
