/* pitviper_memory.h: frames of a Pitviper node in shared memory, and detections sent back to it.
 *
 * One header, no library: C99 or later, C++11 or later, Linux, gcc or clang. Described in etc/reference/memory.md; an
 * example is etc/examples/read_memory.c, for Python etc/examples/read_memory.py.
 *
 * The node writes a ring of slots into /dev/shm/NAME, each with one frame: a record, its targets (kind truth only) and
 * its planes. A reader maps it read-only, so it can change nothing, and the node never waits for a reader; one that is
 * too slow loses frames and can count them.
 *
 *     PitviperMemory m;
 *     int result = pitviper_memory_open(&m, "seeker");
 *     while (result == 0 && (result = pitviper_memory_wait(&m, 1000)) >= 0)
 *         while (pitviper_memory_take_newest(&m) == 1)
 *             look_at((const float *)pitviper_memory_plane(&m, 0), m.plane[0].width, m.plane[0].height);
 *     pitviper_memory_close(&m);
 *
 * Every size and offset in the shared memory is checked before use, and a frame is copied out before it is shown. What
 * a reader cannot guard against is a segment made shorter while it is mapped (SIGBUS); a node never does that.
 *
 * How a slot is protected (a sequence lock): PitviperMemoryRecord.lock is 2 n - 1 while frame n is written and 2 n
 * when it is complete. A copy is good if lock was 2 n before it and after it. All words of a slot are stored with
 * release and loaded with acquire semantics: a reader that has met one word of a newer frame meets the newer lock too.
 * These are plain moves on x86-64; no fences are needed, and there are no data races in the sense of C11. */
#ifndef PITVIPER_MEMORY_H
#define PITVIPER_MEMORY_H

#ifndef _GNU_SOURCE
#define _GNU_SOURCE  /* for syscall() and clock_gettime() with -std=c99; include this header first, or define it there \
                      */
#endif

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- layout -------------------------------------------------------------------------------------- */
/* Numbers are in the byte order of the machine; floating point is IEEE 754, NaN: not computed. Texts are terminated.
 * A later revision may add fields at the end of a structure or in its reserved octets (0 until then); sizes are in the
 * header, so that a reader of one revision reads a ring of another. A change of any other kind is a new version. */

#define PITVIPER_MEMORY_MAGIC      "PVMEMORY"
#define PITVIPER_MEMORY_BYTE_ORDER 0x01020304u
#define PITVIPER_MEMORY_VERSION    1
#define PITVIPER_MEMORY_REVISION   1
#define PITVIPER_MEMORY_FOLDER     "/dev/shm"

enum { pitviper_memory_planes_most = 16, pitviper_memory_slots_most = 1024, pitviper_memory_targets_most = 65536 };
enum { pitviper_memory_bands = 4 }; /* 0 optical, 1 mwir, 2 lwir, 3 radar */

typedef enum PitviperPlaneType { PITVIPER_PLANE_FLOAT32 = 1, PITVIPER_PLANE_UINT16 = 2 } PitviperPlaneType;
typedef enum PitviperMemoryKind { PITVIPER_MEMORY_SENSOR = 1, PITVIPER_MEMORY_TRUTH = 2 } PitviperMemoryKind;
typedef enum PitviperMemoryState { PITVIPER_MEMORY_RUNNING = 1, PITVIPER_MEMORY_CLOSED = 2 } PitviperMemoryState;

/* At the start of the segment. */
typedef struct PitviperMemoryHeader {
    char     magic[8];           /*   0 PITVIPER_MEMORY_MAGIC, without a 0 */
    uint32_t byte_order;         /*   8 */
    uint16_t version, revision;  /*  12 */
    uint32_t header_size;        /*  16 of this structure; the sizes of the others follow */
    uint32_t plane_entry_size;   /*  20 */
    uint32_t record_size;        /*  24 */
    uint32_t target_size;        /*  28 */
    uint64_t segment_size;       /*  32 */
    uint64_t plane_offset;       /*  40 of the plane descriptors, from the start of the segment */
    uint64_t slot_offset;        /*  48 of the first slot */
    uint64_t slot_size;          /*  56 from a slot to the next */
    uint64_t target_offset;      /*  64 of a slot's targets, from the slot's start, where its record is */
    uint32_t slot_count;         /*  72 */
    uint32_t plane_count;        /*  76 */
    uint32_t target_room;        /*  80 targets for which a slot has room */
    uint32_t kind;               /*  84 PitviperMemoryKind */
    uint64_t epoch;              /*  88 another one for each ring: Unix time of its creation, ns */
    int32_t  writer_pid;         /*  96 */
    uint32_t detections_port;    /* 100 UDP on 127.0.0.1 (PitviperDetections); 0: none */
    char     host[24];           /* 104 site:application:entity, or observer; of a run of several hosts; else empty */
    char     program[24];        /* 128 version of the node */
    char     config_sha256[72];  /* 152 of all settings that the pictures depend on, as in run.json */
    uint32_t detections_version; /* 224 newest version of detections that the node takes; revision 0: 0, and takes 1 */
    uint8_t  reserved[28];       /* 228 */
    /* What follows changes while the node runs. */
    uint64_t newest;                /* 256 the newest complete frame, 1, 2, 3 ...; 0: none yet */
    uint32_t wake;                  /* 264 changes with each frame and at the end: a futex */
    uint32_t state;                 /* 268 PitviperMemoryState */
    int64_t  changed_ns;            /* 272 CLOCK_MONOTONIC of the last change */
    uint8_t  reserved_changing[40]; /* 280 */
} PitviperMemoryHeader;

/* A plane, at the same place in every slot: [height][width], rows top down, without gaps. */
typedef struct PitviperMemoryPlane {
    uint32_t band;             /*  0 */
    uint32_t type;             /*  4 PitviperPlaneType */
    uint32_t width, height;    /*  8 */
    uint64_t offset;           /* 16 from the slot's start */
    uint32_t bits;             /* 24 significant ones of counts; 0: floating point */
    uint32_t reserved;         /* 28 */
    char     band_name[16];    /* 32 `optical`, `mwir`, `lwir`, `radar`, or the channel in its place: `swir` */
    char     name[16];         /* 48 `R`, `G`, `B`, `Y`: the channel of the EXR file with the same values */
    char     unit[16];         /* 64 `W/(m2 sr)`; `relative` (radar power); `counts` */
    uint8_t  reserved_end[16]; /* 80 */
} PitviperMemoryPlane;

/* One frame, at the start of its slot. */
typedef struct PitviperMemoryRecord {
    uint64_t lock;                /*   0 see above */
    uint64_t sequence;            /*   8 1, 2, 3 ... in this ring */
    int32_t  frame;               /*  16 number in the run, as in file names and truth.jsonl */
    uint32_t flags;               /*  20 1: the gimbal is at its limit; 2: the sensor is below the ground */
    double   time_s;              /*  24 of the exercise */
    int64_t  unix_us;             /*  32 the same as Unix time, us: exercise time too, never the wall clock */
    double   p_ecef[3];           /*  40 sensor position, m, WGS 84 Earth-centred Earth-fixed */
    double   v_ecef[3];           /*  64 m/s */
    double   r_ecef_from_cam[9];  /*  88 rows of a rotation; camera: x right, y down, z along the boresight */
    double   r_ecef_from_body[9]; /* 160 of the host: x forward, y right, z down */
    double   boresight_ecef[3];   /* 232 unit vector: the third column of r_ecef_from_cam */
    double   hfov_rad, vfov_rad;  /* 256 */
    double   focal_px;            /* 272 principal point at the image's centre; pixel (0, 0)'s centre is (0.5, 0.5) */
    double   distortion[5];       /* 280 k1 k2 p1 p2 k3, as in OpenCV; all 0: none */
    double   scene_rate_px_s[2];  /* 320 columns, rows: image motion of a stationary point at the centre */
    /* Steady clock (CLOCK_MONOTONIC), ns, for latency; 0: not known. */
    int64_t  arrived_ns;        /* 336 the newest datagram that the frame shows */
    int64_t  begun_ns;          /* 344 work on the frame began */
    int64_t  posed_ns;          /* 352 the poses were sampled */
    int64_t  rendered_ns;       /* 360 */
    int64_t  written_ns;        /* 368 the frame is complete in this slot */
    int64_t  seed;              /* 376 of all random numbers */
    uint64_t datagrams;         /* 384 received, or of the recording, when it was rendered */
    uint32_t target_count;      /* 392 in this slot */
    uint32_t targets_left_out;  /* 396 further ones, for which there was no room */
    char     host[24];          /* 400 site:application:entity, or observer */
    char     config_sha256[72]; /* 424 */
    uint8_t  reserved[16];      /* 496 */
} PitviperMemoryRecord;

/* A target in one band. */
typedef struct PitviperMemoryTargetBand {
    double contrast_k;          /*  0 mwir, lwir: mean of its pixels less that of a ring about it, apparent K */
    double dt_rss_k;            /*  8 with the target's own variance */
    double contrast;            /* 16 optical, radar: the same difference over the ring's mean */
    double snr;                 /* 24 contrast over the ring's sigma and the detector's noise */
    double intensity_w_sr;      /* 32 in band, at the aperture */
    double smoke_transmittance; /* 40 of smoke and dust before it; 1: none */
    double reserved[2];         /* 48 */
} PitviperMemoryTargetBand;

/* Kind truth only: a target in the field of view. The same values as in truth.jsonl. */
typedef struct PitviperMemoryTarget {
    uint16_t site, application, entity; /* 0 */
    uint16_t class_number;              /*   6 as category_id of coco.json */
    uint32_t plane_value;               /*   8 of its pixels in the truth plane `entity` */
    uint32_t flags; /*  12 hidden, the larger part: 1 by the ground, 2 by another entity, 4 by plants, 8 by scenery */
    char     class_name[24];       /*  16 `tank`, `truck` ... */
    char     marking[16];          /*  40 raw octets */
    char     type[32];             /*  56 entity type, `1.1.222.1.2.0.0` */
    int32_t  box[4];               /*  88 visible pixels: left, top, right, bottom, the last two beyond; all 0: none */
    double   amodal_box[4];        /* 104 of all of it, hidden parts too, px, not clipped to the image */
    double   range_m, closing_mps; /* 136 */
    double   aspect_rad;           /* 152 0: nose on */
    double   depression_rad;       /* 160 */
    double   los_az_rad, los_el_rad;  /* 168 line of sight from north, and up */
    double   los_rate_rps[2];         /* 184 inertial; camera right and up */
    double   boresight_error_rad[2];  /* 200 camera right and up */
    double   pixels;                  /* 216 visible area */
    double   visible_fraction;        /* 224 of its area */
    double   p_ecef[3], v_ecef[3];    /* 232 of the model's origin, m; m/s */
    double   age_s;                   /* 280 since its last report */
    double   position_error_m;        /* 288 estimate */
    uint8_t  reserved[24];            /* 296 */
    PitviperMemoryTargetBand band[4]; /* 320 */
} PitviperMemoryTarget;

/* ---- detections: one datagram to 127.0.0.1, port PitviperMemoryHeader.detections_port -------------- */
/* One answer per band and frame, without detections where nothing was found. Nodes still take version 2, which ended
 * with reserved[2] behind the class, detections of 64 octets, and version 1, with class_name[16], of 48. Other forms:
 * etc/reference/answers.md. */

#define PITVIPER_DETECTIONS_MAGIC   "PVDETECT"
#define PITVIPER_DETECTIONS_VERSION 3
enum { pitviper_detections_most = 64 };

/* Flags: 0 is a box alone. */
enum { PITVIPER_DETECTION_SIGHT = 1 /* a line of sight is given */, PITVIPER_DETECTION_NO_BOX = 2 /* and it alone */ };

typedef struct PitviperDetection {
    float    left, top, right, bottom; /*  0 px, within the image; right and bottom beyond it; without a box 0 */
    float    score;                    /* 16 0 .. 1 */
    uint32_t track;                    /* 20 the same number for the same object in later frames; 0: none */
    char     class_name[32];           /* 24 printable ASCII, then zeros; the last octet is 0 */
    float    los_az_rad, los_el_rad;   /* 56 at the sensor: from north over east, above the horizontal; else 0 */
    float    range_m;                  /* 64 from the sensor; 0: none */
    uint32_t flags;                    /* 68 */
    uint32_t reserved[2];              /* 72 0 */
} PitviperDetection;

/* Only the first `count` detections are sent: PITVIPER_DETECTIONS_SIZE(count) octets. */
typedef struct PitviperDetections {
    char              magic[8];       /*  0 PITVIPER_DETECTIONS_MAGIC, without a 0 */
    uint32_t          byte_order;     /*  8 PITVIPER_MEMORY_BYTE_ORDER */
    uint16_t          version;        /* 12 PITVIPER_DETECTIONS_VERSION */
    uint16_t          detection_size; /* 14 of one: 80 */
    int32_t           frame;          /* 16 PitviperMemoryRecord.frame of the frame they were found in */
    uint32_t          band;           /* 20 */
    uint32_t          count;          /* 24 */
    uint32_t          reserved;       /* 28 0 */
    PitviperDetection detection[pitviper_detections_most]; /* 32 */
} PitviperDetections;

#define PITVIPER_DETECTIONS_SIZE(count) (offsetof(PitviperDetections, detection) + (count) * sizeof(PitviperDetection))

/* ---- the layout holds on this compiler --------------------------------------------------------------- */

#define PITVIPER_HOLDS_(name, condition)  typedef char pitviper_holds_##name[(condition) ? 1 : -1]
#define PITVIPER_AT_(type, field, octets) PITVIPER_HOLDS_(type##_##field, offsetof(type, field) == (octets))
PITVIPER_HOLDS_(header, sizeof(PitviperMemoryHeader) == 320);
PITVIPER_AT_(PitviperMemoryHeader, segment_size, 32);
PITVIPER_AT_(PitviperMemoryHeader, epoch, 88);
PITVIPER_AT_(PitviperMemoryHeader, config_sha256, 152);
PITVIPER_AT_(PitviperMemoryHeader, detections_version, 224);
PITVIPER_AT_(PitviperMemoryHeader, newest, 256);
PITVIPER_AT_(PitviperMemoryHeader, changed_ns, 272);
PITVIPER_HOLDS_(plane, sizeof(PitviperMemoryPlane) == 96);
PITVIPER_AT_(PitviperMemoryPlane, offset, 16);
PITVIPER_AT_(PitviperMemoryPlane, unit, 64);
PITVIPER_HOLDS_(record, sizeof(PitviperMemoryRecord) == 512);
PITVIPER_AT_(PitviperMemoryRecord, p_ecef, 40);
PITVIPER_AT_(PitviperMemoryRecord, boresight_ecef, 232);
PITVIPER_AT_(PitviperMemoryRecord, arrived_ns, 336);
PITVIPER_AT_(PitviperMemoryRecord, target_count, 392);
PITVIPER_AT_(PitviperMemoryRecord, config_sha256, 424);
PITVIPER_HOLDS_(target_band, sizeof(PitviperMemoryTargetBand) == 64);
PITVIPER_HOLDS_(target, sizeof(PitviperMemoryTarget) == 576);
PITVIPER_AT_(PitviperMemoryTarget, box, 88);
PITVIPER_AT_(PitviperMemoryTarget, pixels, 216);
PITVIPER_AT_(PitviperMemoryTarget, band, 320);
PITVIPER_HOLDS_(detection, sizeof(PitviperDetection) == 80);
PITVIPER_AT_(PitviperDetections, detection, 32);

/* The sizes of revision 0: none is smaller. */
enum {
    pitviper_memory_header_least = 320,
    pitviper_memory_plane_least = 96,
    pitviper_memory_record_least = 512,
    pitviper_memory_target_least = 576
};

/* ---- reading ------------------------------------------------------------------------------------------ */

/* Negative results. */
enum {
    PITVIPER_MEMORY_ABSENT = -1,  /* no such ring (yet): try again later */
    PITVIPER_MEMORY_REFUSED = -2, /* not a ring, of another version or byte order, or damaged */
    PITVIPER_MEMORY_ENDED = -3,   /* the node has closed it, or died: close it, and open again for the next one */
    PITVIPER_MEMORY_SYSTEM = -4   /* a call of the operating system failed: errno */
};

typedef struct PitviperMemory {
    PitviperMemoryHeader header;                             /* as checked */
    PitviperMemoryPlane  plane[pitviper_memory_planes_most]; /* [header.plane_count] */
    PitviperMemoryRecord record;                             /* of the frame taken last */
    uint64_t             taken;                              /* its sequence; 0: none */
    uint64_t             missed;                             /* frames never taken since the first one */
    uint64_t             torn; /* copies discarded because the slot was rewritten meanwhile */
    /* for the functions below */
    const unsigned char *at;
    uint64_t             size;
    unsigned char       *copy; /* [header.slot_size] */
    int                  file, begun;
} PitviperMemory;

static inline const char *pitviper_memory_error(int result)
{
    return result == PITVIPER_MEMORY_ABSENT    ? "no such ring of frames"
           : result == PITVIPER_MEMORY_REFUSED ? "not a ring of frames that this reader understands"
           : result == PITVIPER_MEMORY_ENDED   ? "the node has ended"
           : result == PITVIPER_MEMORY_SYSTEM  ? strerror(errno)
                                               : "no error";
}

/* Steady clock, ns: what the time stamps of a record are compared with. */
static inline int64_t pitviper_memory_now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* Words of the shared memory: each loaded as a whole, none moved before an earlier load. octets: a multiple of 8. */
static inline void pitviper_memory_copy_(void *to, const unsigned char *from, uint64_t octets)
{
    const uint64_t *word = (const uint64_t *)(const void *)from;
    unsigned char  *out = (unsigned char *)to;
    for (uint64_t i = 0; i < octets / 8; i++) {
        const uint64_t value = __atomic_load_n(&word[i], __ATOMIC_ACQUIRE);
        memcpy(out + 8 * i, &value, 8);
    }
}

/* Of a structure of `there` octets, `here` in this header. */
static inline void pitviper_memory_copy_struct_(void *to, uint64_t here, const unsigned char *from, uint64_t there)
{
    const uint64_t both = here < there ? here : there;
    memset(to, 0, here);
    pitviper_memory_copy_(to, from, both / 8 * 8);
}

static inline uint64_t pitviper_memory_plane_octets_(const PitviperMemoryPlane *plane)
{
    return (uint64_t)plane->width * plane->height * (plane->type == PITVIPER_PLANE_FLOAT32 ? 4 : 2);
}

/* Whether `octets` from `offset` on lie within `size`, and start at a multiple of 8. */
static inline int pitviper_memory_within_(uint64_t offset, uint64_t octets, uint64_t size)
{
    return offset % 8 == 0 && offset <= size && octets <= size - offset;
}

static inline int pitviper_memory_header_good_(const PitviperMemoryHeader *h, uint64_t size)
{
    if (memcmp(h->magic, PITVIPER_MEMORY_MAGIC, 8) != 0 || h->byte_order != PITVIPER_MEMORY_BYTE_ORDER ||
        h->version != PITVIPER_MEMORY_VERSION || h->segment_size > size)
        return 0;
    if (h->header_size < pitviper_memory_header_least || h->plane_entry_size < pitviper_memory_plane_least ||
        h->record_size < pitviper_memory_record_least || h->target_size < pitviper_memory_target_least)
        return 0;
    if (h->header_size % 8 || h->plane_entry_size % 8 || h->record_size % 8 || h->target_size % 8) return 0;
    if (h->slot_count < 1 || h->slot_count > pitviper_memory_slots_most || h->plane_count < 1 ||
        h->plane_count > pitviper_memory_planes_most || h->target_room > pitviper_memory_targets_most)
        return 0;
    if (!pitviper_memory_within_(h->plane_offset, (uint64_t)h->plane_count * h->plane_entry_size, h->segment_size))
        return 0;
    if (h->slot_size % 8 || h->slot_size > h->segment_size / h->slot_count ||
        !pitviper_memory_within_(h->slot_offset, h->slot_size * h->slot_count, h->segment_size))
        return 0;
    return h->record_size <= h->slot_size &&
           pitviper_memory_within_(h->target_offset, (uint64_t)h->target_room * h->target_size, h->slot_size);
}

static inline int pitviper_memory_plane_good_(const PitviperMemoryPlane *p, uint64_t slot_size)
{
    if (p->band >= pitviper_memory_bands || p->width < 1 || p->width > 65536 || p->height < 1 || p->height > 65536 ||
        (p->type != PITVIPER_PLANE_FLOAT32 && p->type != PITVIPER_PLANE_UINT16))
        return 0;
    return pitviper_memory_within_(p->offset, (pitviper_memory_plane_octets_(p) + 7) / 8 * 8, slot_size);
}

static inline void pitviper_memory_close(PitviperMemory *m)
{
    if (m->at) munmap((void *)(uintptr_t)m->at, (size_t)m->size);
    if (m->file >= 0) close(m->file);
    free(m->copy);
    memset(m, 0, sizeof *m);
    m->file = -1;
}

static inline int pitviper_memory_map_(PitviperMemory *m)
{
    struct stat status;
    if (fstat(m->file, &status) != 0) return PITVIPER_MEMORY_SYSTEM;
    if (!S_ISREG(status.st_mode) || status.st_size < (off_t)pitviper_memory_header_least)
        return PITVIPER_MEMORY_REFUSED;
    m->size = (uint64_t)status.st_size;
    void *const at = mmap(NULL, (size_t)m->size, PROT_READ, MAP_SHARED, m->file, 0);
    if (at == MAP_FAILED) return PITVIPER_MEMORY_SYSTEM;
    m->at = (const unsigned char *)at;
    pitviper_memory_copy_(&m->header, m->at, sizeof m->header);
    PitviperMemoryHeader *h = &m->header;
    if (!pitviper_memory_header_good_(h, m->size)) return PITVIPER_MEMORY_REFUSED;
    h->host[sizeof h->host - 1] = h->program[sizeof h->program - 1] = h->config_sha256[sizeof h->config_sha256 - 1] = 0;
    for (uint32_t i = 0; i < h->plane_count; i++) {
        PitviperMemoryPlane *p = &m->plane[i];
        pitviper_memory_copy_struct_(p, sizeof *p, m->at + h->plane_offset + (uint64_t)i * h->plane_entry_size,
                                     h->plane_entry_size);
        p->band_name[sizeof p->band_name - 1] = p->name[sizeof p->name - 1] = p->unit[sizeof p->unit - 1] = 0;
        if (!pitviper_memory_plane_good_(p, h->slot_size)) return PITVIPER_MEMORY_REFUSED;
    }
    m->copy = (unsigned char *)malloc((size_t)h->slot_size);
    if (!m->copy) return PITVIPER_MEMORY_SYSTEM;
    m->taken = h->newest > h->slot_count ? h->newest - h->slot_count : 0; /* in order: from the oldest that is there */
    return 0;
}

/* Of an open file, which is closed with it, also on failure; whether its node lives is not asked. */
static inline int pitviper_memory_open_file(PitviperMemory *m, int file)
{
    memset(m, 0, sizeof *m);
    m->file = file;
    const int result = pitviper_memory_map_(m);
    if (result < 0) {
        const int reason = errno;
        pitviper_memory_close(m);
        errno = reason;
    }
    return result;
}

/* Whether the process that writes it lives and has not closed it. It holds a lock on the file for as long as it lives,
 * which is asked for here without taking one; process ids are used again, this lock is not. */
static inline int pitviper_memory_is_alive(const PitviperMemory *m)
{
    const PitviperMemoryHeader *h = (const PitviperMemoryHeader *)(const void *)m->at;
    struct flock                lock;
    memset(&lock, 0, sizeof lock);
    lock.l_type = F_RDLCK;
    lock.l_whence = SEEK_SET;
    if (__atomic_load_n(&h->state, __ATOMIC_ACQUIRE) != PITVIPER_MEMORY_RUNNING) return 0;
    enum { query_lock_of_open_file = 36 }; /* F_OFD_GETLK, which needs _GNU_SOURCE before the first system header */
    return fcntl(m->file, query_lock_of_open_file, &lock) == 0 && lock.l_type != F_UNLCK;
}

/* 0: open. Else negative, and nothing is to be closed. */
static inline int pitviper_memory_open(PitviperMemory *m, const char *name)
{
    char   path[256] = PITVIPER_MEMORY_FOLDER "/";
    size_t length = strlen(path);
    memset(m, 0, sizeof *m);
    m->file = -1;
    if (!*name || strchr(name, '/') || length + strlen(name) >= sizeof path) return PITVIPER_MEMORY_ABSENT;
    memcpy(path + length, name, strlen(name) + 1);
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) return errno == ENOENT ? PITVIPER_MEMORY_ABSENT : PITVIPER_MEMORY_SYSTEM;
    const int result = pitviper_memory_open_file(m, file);
    if (result < 0 || pitviper_memory_is_alive(m)) return result;
    pitviper_memory_close(m);
    return PITVIPER_MEMORY_ENDED;
}

/* One wait for a change of `wake`, at most so long. Where the kernel refuses a futex in memory that is mapped
 * read-only, a short sleep. */
static inline void pitviper_memory_sleep_(const PitviperMemoryHeader *h, uint32_t wake, int64_t ns)
{
    struct timespec time;
    time.tv_sec = (time_t)(ns / 1000000000);
    time.tv_nsec = (long)(ns % 1000000000);
    enum { futex_wait = 0 };
    if (syscall(SYS_futex, &h->wake, futex_wait, wake, &time, (void *)0, 0) == 0 || errno == EAGAIN || errno == EINTR ||
        errno == ETIMEDOUT)
        return;
    time.tv_sec = 0;
    time.tv_nsec = ns < 500000 ? (long)ns : 500000;
    nanosleep(&time, NULL);
}

/* Waits for a frame that has not been taken, without spinning. 1: there is one; 0: not within timeout_ms (negative: no
 * limit); PITVIPER_MEMORY_ENDED: no further frame will come. */
static inline int pitviper_memory_wait(PitviperMemory *m, int timeout_ms)
{
    static const int64_t        slice_ns = 200000000; /* a node that was killed wakes no reader: asked for this often */
    const PitviperMemoryHeader *h = (const PitviperMemoryHeader *)(const void *)m->at;
    const int64_t end_ns = timeout_ms < 0 ? INT64_MAX : pitviper_memory_now_ns() + (int64_t)timeout_ms * 1000000;
    for (;;) {
        const uint32_t wake = __atomic_load_n(&h->wake, __ATOMIC_ACQUIRE);
        const uint64_t newest = __atomic_load_n(&h->newest, __ATOMIC_ACQUIRE);
        if (newest > UINT64_MAX / 2) return PITVIPER_MEMORY_REFUSED;
        if (newest > m->taken) return 1;
        if (!pitviper_memory_is_alive(m))
            return __atomic_load_n(&h->newest, __ATOMIC_ACQUIRE) > m->taken ? 1 : PITVIPER_MEMORY_ENDED;
        const int64_t left_ns = end_ns - pitviper_memory_now_ns();
        if (left_ns <= 0) return 0;
        pitviper_memory_sleep_(h, wake, left_ns < slice_ns ? left_ns : slice_ns);
    }
}

/* Copies frame n out of its slot. False: it is not there, or was overwritten meanwhile. */
static inline int pitviper_memory_copy_frame_(PitviperMemory *m, uint64_t n)
{
    const PitviperMemoryHeader *h = &m->header;
    const unsigned char        *slot = m->at + h->slot_offset + (n - 1) % h->slot_count * h->slot_size;
    const uint64_t             *lock = (const uint64_t *)(const void *)slot;
    PitviperMemoryRecord        record;
    if (__atomic_load_n(lock, __ATOMIC_ACQUIRE) != 2 * n) return 0;
    m->record.sequence = 0; /* the planes of the frame taken before are overwritten */
    pitviper_memory_copy_struct_(&record, sizeof record, slot, h->record_size);
    if (record.target_count > h->target_room) record.target_count = h->target_room;
    pitviper_memory_copy_(m->copy + h->target_offset, slot + h->target_offset,
                          (uint64_t)record.target_count * h->target_size);
    for (uint32_t i = 0; i < h->plane_count; i++)
        pitviper_memory_copy_(m->copy + m->plane[i].offset, slot + m->plane[i].offset,
                              (pitviper_memory_plane_octets_(&m->plane[i]) + 7) / 8 * 8);
    if (__atomic_load_n(lock, __ATOMIC_ACQUIRE) != 2 * n) {
        m->torn++;
        return 0;
    }
    record.host[sizeof record.host - 1] = record.config_sha256[sizeof record.config_sha256 - 1] = 0;
    m->record = record;
    m->record.sequence = n;
    return 1;
}

static inline int pitviper_memory_take_(PitviperMemory *m, int in_order)
{
    enum { tries = 16 };
    const PitviperMemoryHeader *h = (const PitviperMemoryHeader *)(const void *)m->at;
    const uint64_t              slots = m->header.slot_count;
    uint64_t                    least = m->taken + 1; /* earlier ones are taken, or gone */
    for (int i = 0; i < tries; i++) {
        const uint64_t newest = __atomic_load_n(&h->newest, __ATOMIC_ACQUIRE);
        if (newest < least || newest > UINT64_MAX / 2) return 0;
        if (!in_order) least = newest;
        else if (newest - least >= slots) least = newest - slots + 1;
        if (pitviper_memory_copy_frame_(m, least)) {
            if (m->begun) m->missed += least - m->taken - 1;
            m->begun = 1;
            m->taken = least;
            return 1;
        }
        if (in_order) least++;
    }
    return 0;
}

/* 1: a frame that was not taken before is in m->record, and its planes and targets can be had; 0: there is none.
 * take_newest skips what is older than the newest; take_next begins with the oldest that the ring holds and takes
 * frames in order, except those that are overwritten before. m->missed counts what was skipped since the first one. */
static inline int pitviper_memory_take_newest(PitviperMemory *m) { return pitviper_memory_take_(m, 0); }
static inline int pitviper_memory_take_next(PitviperMemory *m) { return pitviper_memory_take_(m, 1); }

/* Of the frame taken last, until the next call that takes one: const float * or const uint16_t *, by
 * plane[index].type. */
static inline const void *pitviper_memory_plane(const PitviperMemory *m, uint32_t index)
{
    return index < m->header.plane_count && m->record.sequence ? m->copy + m->plane[index].offset : NULL;
}

/* False: there is none. */
static inline int pitviper_memory_target(PitviperMemoryTarget *out, const PitviperMemory *m, uint32_t index)
{
    if (index >= m->record.target_count || !m->record.sequence) return 0;
    const uint64_t there = m->header.target_size, here = sizeof *out;
    memset(out, 0, sizeof *out);
    memcpy(out, m->copy + m->header.target_offset + index * there, (size_t)(there < here ? there : here));
    out->class_name[sizeof out->class_name - 1] = out->marking[sizeof out->marking - 1] = 0;
    out->type[sizeof out->type - 1] = 0;
    return 1;
}

/* Without a copy: the slot of the newest frame in the shared memory itself; its planes are at plane[i].offset from
 * there. What is found in it counts only if pitviper_memory_is_intact afterwards. NULL: there is none. */
static inline const unsigned char *pitviper_memory_in_place(const PitviperMemory *m, uint64_t *sequence)
{
    const PitviperMemoryHeader *h = (const PitviperMemoryHeader *)(const void *)m->at;
    const uint64_t              n = __atomic_load_n(&h->newest, __ATOMIC_ACQUIRE);
    *sequence = n;
    if (n == 0 || n > UINT64_MAX / 2) return NULL;
    const unsigned char *slot = m->at + m->header.slot_offset + (n - 1) % m->header.slot_count * m->header.slot_size;
    return __atomic_load_n((const uint64_t *)(const void *)slot, __ATOMIC_ACQUIRE) == 2 * n ? slot : NULL;
}

static inline int pitviper_memory_is_intact(const unsigned char *slot, uint64_t sequence)
{
#ifndef __SANITIZE_THREAD__
    __atomic_thread_fence(__ATOMIC_ACQUIRE); /* for loads that the caller made, which are not atomic ones */
#endif
    return __atomic_load_n((const uint64_t *)(const void *)slot, __ATOMIC_ACQUIRE) == 2 * sequence;
}

#ifdef __cplusplus
}
#endif
#endif
