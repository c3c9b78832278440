/* sensor/publish/pair_record.h: pairs.jsonl (sensor/publish/pairs.h): a line per frame with all its members and
 * their files. */
#ifndef SENSOR_PUBLISH_PAIR_RECORD_H
#define SENSOR_PUBLISH_PAIR_RECORD_H

#include "sensor/publish/frame_files.h"

enum { pair_members = 1 + pair_folders };

typedef struct PairMember {
    bool        target, noise;
    const char *radiance, *shown;       /* folders below the run's: of radiance and truth, of displays and raw counts */
    const FrameDisplay *display;        /* [BAND_COUNT] values of black and white */
} PairMember;

typedef struct PairRecord {
    int       frame;
    double    time_s;
    long long seed;
    int       removed_count;
    const DisEntityId *removed;         /* removed entities */
    const char *frame_sha256, *background_sha256;
    unsigned  bands, raw;               /* 1 << Band: rendered; with raw counts */
    bool      png, truth;
    PairMember member[pair_members];
} PairRecord;

/* One line, flushed. STATUS_IO when it cannot be written; STATUS_NO_MEMORY. */
Status record_write_pair(FILE *file, const PairRecord *record);

#endif
