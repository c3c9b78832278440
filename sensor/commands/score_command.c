/* sensor/commands/score_command.c: `pitviper score OUT ANSWERS`: a recogniser's answers against the truth of a run. */
#include "sensor/commands/commands.h"

#include "sensor/commands/overwrite.h"
#include "sensor/score/score_page.h"
#include "sensor/settings/command_line.h"

#include <sys/stat.h>

static const char help[] =
    "usage: pitviper score OUT [ANSWERS ...] [options]\n"
    "\n"
    "Scores a recogniser's answers against the truth of a run: detection rate and false alarms, against range, size,\n"
    "aspect, visibility, foliage, SNR and hour; average precision by class; confusion; errors of centre and range;\n"
    "age. Of up to four recognisers side by side. Intervals of 95 % take frames of one orbit as one sample.\n"
    "\n"
    "OUT: a folder of `pitviper replay` or `run`, of several hosts, or of a sweep. ANSWERS (default OUT): a file, or a\n"
    "folder with answers.jsonl (of several hosts or a sweep: SEQUENCE/answers.jsonl). A file has\n"
    "  lines of JSON        frame, band, class, score, and box_px [left, top, right, bottom] or los_deg [azimuth from\n"
    "                       north, elevation]; optional track, range_m, latency_ms (`pitviper help answers`)\n"
    "  or COCO results      [{image_id, category_id, bbox, score}], by the images of OUT/coco.json\n"
    "Writes score.json (`pitviper help score.json`) and score.html into OUT.\n"
    "\n"
    "  --bands LIST         bands to be scored (default: those that were answered)\n"
    "  --score S            answers of a lower score do not count in rates and confusion (0)\n"
    "  --answered           only frames that were answered; else those without an answer are misses\n"
    "  --max-age MS         drop answers that came later after the frame than that\n"
    "  --small-px PX        a target of fewer visible pixels is found by an answer's centre, 0 .. 1e9 (100)\n"
    "  --grow SHARE         in its amodal box, larger by this share, 0 .. 10 (0.25)\n"
    "  --iou IOU            a larger one by the overlap of boxes, above 0 .. 1 (0.3)\n"
    "  --min-pixels N       smaller targets are ignore regions, as in coco.json, 1 .. 1000000 (5)\n"
    "  --min-visible SHARE  those that are more hidden, too, 0 .. 1 (0)\n"
    "  --min-snr SNR        and those of less SNR in the band, 0 .. 1000 (0.1). Where OUT has a coco.json, that\n"
    "                       decides, and these three have no effect\n"
    "  --out FOLDER         or -o: where these go (OUT)\n"
    "  --overwrite          replace them; without it that is an error\n"
    "  --help               print this help\n";

typedef struct ScoreOptions {
    ScoreRequest request;
    const char  *out;
    bool         overwrite;
} ScoreOptions;

/* A number; returns 0 to go on, else the exit code + 1. */
static int take(double *out, const char *option, const char *text, double low, double high)
{
    double number;
    if (text_to_double(&number, text) && number >= low && number <= high) {
        *out = number;
        return 0;
    }
    return 1 + command_line_wrong("score", "%s: '%s' is not a number in %g .. %g", option, text, low, high);
}

static int take_whole(int *out, const char *option, const char *text, int low, int high)
{
    double    number = 0;
    const int stop = take(&number, option, text, low, high);
    if (stop) return stop;
    if (number != floor(number)) return 1 + command_line_wrong("score", "%s: '%s' is no whole number", option, text);
    *out = (int)number;
    return 0;
}

static int take_folders(ScoreOptions *o, int argc, char **argv)
{
    ScoreRequest *q = &o->request;
    if (optind >= argc) return 1 + command_line_wrong("score", "OUT is needed: the folder of a run");
    q->out = argv[optind++];
    if (argc - optind > score_recognisers_max)
        return 1 + command_line_wrong("score", "at most %d files of answers, not also '%s'", score_recognisers_max,
                                      argv[optind + score_recognisers_max]);
    while (optind < argc) {
        if (!*argv[optind]) return 1 + command_line_wrong("score", "the name of the answers is empty");
        q->answers[q->recognisers++] = argv[optind++];
    }
    return *q->out ? 0 : 1 + command_line_wrong("score", "the name of OUT is empty");
}

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(ScoreOptions *o, int argc, char **argv)
{
    enum { BANDS = 256, SCORE, ANSWERED, AGE, SMALL, GROW, IOU, PIXELS, VISIBLE, SNR, OVERWRITE, HELP, OUT = 'o' };
    static const struct option options[] = {{"bands", 1, NULL, BANDS},
                                            {"score", 1, NULL, SCORE},
                                            {"answered", 0, NULL, ANSWERED},
                                            {"max-age", 1, NULL, AGE},
                                            {"small-px", 1, NULL, SMALL},
                                            {"grow", 1, NULL, GROW},
                                            {"iou", 1, NULL, IOU},
                                            {"min-pixels", 1, NULL, PIXELS},
                                            {"min-visible", 1, NULL, VISIBLE},
                                            {"min-snr", 1, NULL, SNR},
                                            {"out", 1, NULL, OUT},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    ScoreRules                *r = &o->request.rules;
    int                        stop = 0;
    *o = (ScoreOptions){.request.rules = score_default_rules()};
    optind = 0; /* start anew */
    for (int option; !stop && (option = command_line_option(argc, argv, "ho:", options)) != -1;) switch (option) {
        case BANDS:
            if (!config_bands_choose(&o->request.bands, optarg)) return 1 + 2;
            break;
        case SCORE:
            stop = take(&r->least_score, "--score", optarg, -1e9, 1e9);
            break;
        case ANSWERED:
            r->answered = true;
            break;
        case AGE:
            stop = take(&r->max_age_ms, "--max-age", optarg, 0, 1e9);
            break;
        case SMALL:
            stop = take(&r->small_px, "--small-px", optarg, 0, 1e9);
            break;
        case GROW:
            stop = take(&r->grow, "--grow", optarg, 0, 10);
            break;
        case IOU:
            stop = take(&r->iou, "--iou", optarg, 1e-6, 1);
            break;
        case PIXELS:
            stop = take_whole(&r->min_pixels, "--min-pixels", optarg, 1, 1000000);
            break;
        case VISIBLE:
            stop = take(&r->min_visible, "--min-visible", optarg, 0, 1);
            break;
        case SNR:
            stop = take(&r->min_snr, "--min-snr", optarg, 0, 1000);
            break;
        case OUT:
            if (!*optarg) return 1 + command_line_wrong("score", "--out needs a folder");
            o->out = optarg;
            break;
        case OVERWRITE:
            o->overwrite = true;
            break;
        case HELP:
        case 'h':
            fputs(help, stdout);
            return 1;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    return stop ? stop : take_folders(o, argc, argv);
}

static bool is_folder(const char *path)
{
    struct stat there;
    if (stat(path, &there) == 0 && S_ISDIR(there.st_mode)) return true;
    log_error("score: there is no folder '%s'; name one that `pitviper replay LOG --out OUT` wrote", path);
    return false;
}

int score_command(int argc, char **argv)
{
    static const char *const names[] = {"score.json", "score.html"};
    ScoreOptions             o;
    ScoreReport              report = {0};
    OutputPath               path[2];
    const int                stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    if (!is_folder(o.request.out)) return 1;
    const OutputFiles files = {.command = "score",
                               .count = 2,
                               .name = names,
                               .given = o.out ? o.out : o.request.out,
                               .model = "",
                               .endings = "",
                               .overwrite = o.overwrite};
    Status            status = overwrite_files(path, &files);
    if (status == STATUS_OK) status = score_run(&report, &o.request);
    if (status == STATUS_OK) score_print(stdout, &report, true);
    if (status == STATUS_OK) status = score_write_json(&report, path[0]);
    if (status == STATUS_OK) status = score_write_page(&report, path[1]);
    score_report_free(&report);
    return status == STATUS_OK ? 0 : 1;
}
