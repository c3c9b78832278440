/* sensor/score/answers.h: the answers of a recogniser, in whatever form they came, in the order of frames.
 *
 *     answers.jsonl   as a node writes it (`pitviper help answers`), or by hand: a line of JSON a detection with
 * `frame`, `class`, and `box_px` or `los_deg` ([azimuth from north over east, elevation] in ENU at the sensor); `band`
 * where truth has several; `score` (1 without), `track`, `range_m`, `latency_ms`, `late`, `sequence` (the folder's
 * name, where OUT has several). A line without a class says that nothing was found. COCO results    a list of
 * {"image_id", "category_id", "bbox", "score"}, by the images of OUT/coco.json
 *
 * All are held: 80 octets each. Other keys are ignored. */
#ifndef SENSOR_SCORE_ANSWERS_H
#define SENSOR_SCORE_ANSWERS_H

#include "sensor/score/coco_truth.h"
#include "sensor/score/report.h"

typedef struct Answer {
    double   box[4];         /* left, top, width, height, px, as COCO; of a line of sight azimuth and elevation, deg */
    double   score, range_m; /* range NaN: none */
    float    latency_ms;     /* NaN: not known */
    int      sequence, frame;
    uint32_t track;                      /* 0: none */
    uint8_t  band, class_number;         /* 0: unknown */
    bool     found, line_of_sight, late; /* found false: the frame was answered, and nothing found */
} Answer;

typedef struct Answers {
    size_t     count, room;
    Answer    *one;                    /* sorted by answers_order */
    unsigned   bands;                  /* of any */
    bool       lines_of_sight, tracks; /* some are, or have */
    int        words, words_room;      /* those that are no class, in the order of their coming */
    ScoreWord *word;
} Answers;

/* Names of the sequences, folders in OUT; "" where OUT is the only one. */
typedef struct AnswerSequences {
    int count;
    char (*name)[256];
    int default_band; /* of a line without one; -1: truth has several */
} AnswerSequences;

enum { answers_words_most = 1000, answers_most = 100000000 };

/* Adds those of a file. sequence: of lines that name none; -1: they must. images: of COCO results; NULL: there are
 * none. STATUS_IO, STATUS_BAD_VALUE, STATUS_NO_MEMORY, logged. */
Status answers_read(Answers *answers, const char *path, int sequence, const AnswerSequences *sequences,
                    const CocoImages *images);
/* The same of a stream, which is left open. */
Status answers_read_stream(Answers *answers, JsonStream *stream, int sequence, const AnswerSequences *sequences,
                           const CocoImages *images);
/* After the last: sorts them. */
void answers_sort(Answers *answers);
void answers_free(Answers *answers);

/* Of one frame and band: the first and how many, by falling score; those that found nothing are the last. */
const Answer *answers_of(size_t *count, const Answers *answers, int sequence, int frame, Band band);

/* A total order over all that an answer says: sequence, frame, band, found, score from the highest, then the rest. */
int answers_order(const void *a, const void *b);

/* Truth's class of a word, without regard to case; 0: unknown. */
uint8_t answers_class(const char *word);

#endif
