/* tests/fuzz/fuzz_marks.c: any octets as a file of ground marks. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/traces/ground_marks.h"

#include <stdlib.h>

const int fuzz_rounds = 3000;

/* What the program writes: a mark of each kind, or a stand of a past and one that goes on. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char head[] =
        "# Ground marks\nkind,owner,from_unix_s,to_unix_s,x_m,y_m,z_m,to_x_m,to_y_m,to_z_m,r11,r12,r13,r21,r22,r23,r31,r32,"
        "r33,low_x_m,low_y_m,low_z_m,high_x_m,high_y_m,high_z_m,width_m,apart_m,tracked,radius_m,crater_m,heat_j_m2\n";
    static const char *const rows[2] = {
        "stand,4295163905,1782032400,1782036012,6378137,77.125,0,,,,0,0,-1,0,1,0,1,0,0,-3.5,-1.75,-2.5,5.5,1.75,0,,,,,,\n"
        "track,,1782036000,1782036005,6378137,0,0,6378137,0,50,,,,,,,,,,,,,,,,0.58,3.04,1,,,11234.5\n"
        "burn,,1782036100.5,,6378137.3333333,5,6,,,,,,,,,,,,,,,,,,,,,,2.5,0.4,100000\n",
        "stand,7,-5,,6378137,0,0,,,,1,0,0,0,1,0,0,0,1,-1,-1,-1,1,1,1,,,,,,\n"
        "stand,8,-5,3,0,6378137,0,,,,0,0,-1,0,1,0,1,0,0,-1,-1,-1,1,1,1,,,,,,\n"};
    const size_t size = fuzz_seed_text(out, head);
    return size + fuzz_seed_text(out + size, rows[index % 2]);
}

/* A file undamaged is accepted, or nothing behind it is tried. */
static void try_seeds(void)
{
    static uint8_t seed[fuzz_seed_octets];
    for (uint32_t i = 0; i < 2; i++) {
        char           path[fuzz_path_size];
        GroundHistory *h = NULL;
        const int      file = fuzz_file(path, seed, fuzz_seed(seed, i));
        if (file < 0 || ground_history_create(&h) != STATUS_OK || ground_marks_load(h, 0, path) != STATUS_OK) abort();
        ground_history_destroy(h);
        close(file);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static bool begun = false;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (!begun) try_seeds();
    begun = true;
    char           path[fuzz_path_size];
    GroundHistory *h = NULL;
    GroundMarks    m;
    GroundTrack   *tail;
    const int      file = fuzz_file(path, data, size);
    if (file < 0) return 0;
    Arena *arena = arena_create();
    if (!arena || ground_history_create(&h) != STATUS_OK) abort();
    const Status status = ground_marks_load(h, 1782036000, path);
    if (ground_marks_at(&m, &tail, h, 1e13, 0, arena) != STATUS_OK) abort();
    if (status != STATUS_OK && (m.stands || m.tracks || m.burns)) abort();
    for (int i = 0; i < m.stands; i++) {
        const GroundStand *s = &m.stand[i];
        if (!v3_is_finite(s->p_ecef) || !(s->from_s <= s->to_s) || s->owner == 0) abort();
        for (int k = 0; k < 3; k++)
            if (!(s->low_m[k] <= s->high_m[k])) abort();
    }
    for (int i = 0; i < m.tracks; i++) {
        const GroundTrack *t = &m.track[i];
        if (!v3_is_finite(t->a_ecef) || !v3_is_finite(t->b_ecef) || !(t->a_s <= t->b_s) || !(t->heat_j_m2 >= 0))
            abort();
    }
    for (int i = 0; i < m.burns; i++)
        if (!v3_is_finite(m.burn[i].p_ecef) || !isfinite(m.burn[i].t_s) || !(m.burn[i].radius_m >= 0)) abort();
    arena_destroy(arena);
    ground_history_destroy(h);
    close(file);
    return 0;
}
