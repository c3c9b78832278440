/* sensor/commands/inspect.c: `pitviper inspect`: its options, the log, and which of the two formats is printed. */
#include "sensor/commands/inspect.h"
#include "sensor/commands/inspect_private.h"
#include "sensor/settings/config.h"
#include "sensor/settings/next_option.h"

#include <stdio.h>

static const char usage_text[] =
    "usage: pitviper inspect LOG [--pdus tsv [--full]] [--port N] [--exercise N] [-c FILE]\n"
    "\n"
    "LOG is a pcap or pcapng capture, also compressed (gzip, zstd, bzip2, xz) or a pipe. Without --pdus: a summary of\n"
    "the exercise.\n"
    "\n"
    "  --pdus tsv    one line per Entity State PDU, with the columns and formats of\n"
    "                tshark -d udp.port==3000,dis -T fields\n"
    "  --full        with --pdus tsv: also entity type, dead reckoning, capabilities,\n"
    "                alternative type and articulation (change:attached:parameter:value; ...)\n"
    "  --port N      UDP destination port; 0: any that carries DIS (default: 3000, any when nothing went there)\n"
    "  --exercise N  only this exercise, 0 .. 255; default: all\n"
    "  --config FILE or -c: settings, whose models.catalog and models.materials are read\n";

typedef struct Options {
    const char *path, *config;
    bool        tsv, full;
    long long   port, exercise; /* exercise -1: all */
} Options;

/* 0: go on; else exit with this code - 1. */
static int read_options(Options *o, int argc, char **argv)
{
    enum { CONFIG = 'c', PDUS = 256, FULL, PORT, EXERCISE, HELP };
    static const struct option options[] = {
        {"pdus", 1, NULL, PDUS}, {"full", 0, NULL, FULL}, {"port", 1, NULL, PORT}, {"exercise", 1, NULL, EXERCISE},
        {"config", 1, NULL, CONFIG}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    *o = (Options){.port = dis_port_default, .exercise = -1};
    optind = 0; /* restart getopt */
    for (int option; (option = next_option(argc, argv, "c:", options)) != -1;)
        switch (option) {
        case PDUS:
            if (strcmp(optarg, "tsv") != 0) return 1 + wrong_line("inspect", "--pdus: '%s' is not tsv", optarg);
            o->tsv = true;
            break;
        case FULL: o->full = true; break;
        case CONFIG: o->config = optarg; break;
        case PORT:
            if (!text_to_long(&o->port, optarg) || o->port < 0 || o->port > 65535)
                return 1 + wrong_line("inspect", "--port: '%s' is not a whole number in 0 .. 65535", optarg);
            break;
        case EXERCISE:
            if (!text_to_long(&o->exercise, optarg) || o->exercise < 0 || o->exercise > 255)
                return 1 + wrong_line("inspect", "--exercise: '%s' is not a whole number in 0 .. 255", optarg);
            break;
        case HELP: fputs(usage_text, stdout); return 1 + 0;
        default: return 1 + 2; /* reported by next_option */
        }
    if (optind == argc) return 1 + wrong_line("inspect", "no LOG is named: usage: pitviper inspect LOG [options]");
    o->path = argv[optind];
    if (optind + 1 < argc) return 1 + wrong_line("inspect", "one LOG at a time, not also '%s'", argv[optind + 1]);
    if (o->full && !o->tsv) return 1 + wrong_line("inspect", "--full applies to --pdus tsv only");
    return 0;
}

int inspect_command(int argc, char **argv)
{
    Options   options;
    const int stop = read_options(&options, argc, argv);
    if (stop || config_tables_of(options.config) != STATUS_OK) return stop ? stop - 1 : 1;

    DisLog log;
    Status status = dis_log_open(&log, options.path, (int)options.port);
    if (status == STATUS_NO_MEMORY) log_error("inspect: %s: %s", options.path, status_name(status));
    if (status != STATUS_OK) return 1; /* all other errors have been logged */
    if (log.retimed)
        log_warn("inspect: packet times do not keep pace with the time stamps; the stamps are taken as the clock");
    if (log.any_port && options.port == dis_port_default)
        log_warn("inspect: nothing went to port %d: every port that carries DIS is taken; --port N chooses", dis_port);
    if (log.count == 0 && options.port > 0 && log.counters.other_port)
        log_warn("inspect: no UDP to port %lld in %s; try --port 0", options.port, options.path);

    if (options.tsv)
        inspect_tsv(&log, options.path, (int)options.exercise, options.full);
    else
        status = inspect_summary(&log, options.path, (int)options.exercise);
    if (status == STATUS_OK && dis_log_failed(&log)) status = STATUS_IO;
    dis_log_close(&log);
    if (status != STATUS_OK) {
        log_error("inspect: %s: %s", options.path, status_name(status));
        return 1;
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        log_error("inspect: cannot write the output; is the disk full or the pipe closed?");
        return 1;
    }
    return 0;
}
