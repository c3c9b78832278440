/* Classes of targets: numbers that were published keep their names, and types have the class that their category in
 * SISO-REF-010 says. */
#include "tests/check.h"

#include "sensor/frame/target_record.h"

/* Never change a line of this list: recognisers have been trained with these numbers. Add behind it. */
static void numbers_keep_their_names(void **state)
{
    (void)state;
    static const char *const published[] = {"tank",
                                            "apc",
                                            "artillery",
                                            "towed_gun",
                                            "mortar",
                                            "air_defense",
                                            "radar",
                                            "jeep",
                                            "truck",
                                            "tracked_utility",
                                            "trailer",
                                            "engineering",
                                            "car",
                                            "bus",
                                            "motorcycle",
                                            "train",
                                            "robot",
                                            "shelter",
                                            "tent",
                                            "fighter",
                                            "attack_aircraft",
                                            "bomber",
                                            "transport_aircraft",
                                            "surveillance_aircraft",
                                            "trainer",
                                            "airliner",
                                            "light_aircraft",
                                            "helicopter",
                                            "uav",
                                            "airship",
                                            "aircraft_carrier",
                                            "warship",
                                            "amphibious_ship",
                                            "patrol_boat",
                                            "landing_craft",
                                            "cargo_ship",
                                            "boat",
                                            "submarine",
                                            "uuv",
                                            "satellite",
                                            "missile",
                                            "torpedo",
                                            "bomb",
                                            "shell",
                                            "mine",
                                            "person",
                                            "animal",
                                            "building",
                                            "bridge",
                                            "supplies",
                                            "flare",
                                            "decoy",
                                            "buoy",
                                            "other"};
    CHECK(target_class_count() == sizeof published / sizeof *published);
    for (int k = 1; k <= target_class_count(); k++) {
        assert_string_equal(target_class_name(k), published[k - 1]);
        CHECK(target_class_group(k) && *target_class_group(k));
        for (int i = 1; i < k; i++) CHECK(strcmp(target_class_name(i), target_class_name(k)) != 0);
    }
}

/* Types by their public names (SISO-REF-010; open-dis and Wireshark's transcriptions). */
static void types_have_the_class_of_their_category(void **state)
{
    (void)state;
    static const struct {
        DisEntityType type;
        const char *class;
    } known[] = {
        {{1, 1, 225, 1, 1, 3, 0}, "tank"},      /* M1A2 */
        {{1, 1, 222, 1, 2, 1, 0}, "tank"},      /* T-72 */
        {{1, 1, 225, 2, 1, 1, 0}, "apc"},       /* M2 */
        {{1, 1, 222, 2, 2, 0, 0}, "apc"},       /* BMP-2 */
        {{1, 1, 225, 2, 3, 0, 0}, "apc"},       /* M113 */
        {{1, 1, 225, 4, 3, 0, 0}, "artillery"}, /* M109 */
        {{1, 1, 225, 5, 2, 0, 0}, "towed_gun"}, /* M198 */
        {{1, 1, 225, 6, 1, 0, 0}, "jeep"},      /* HMMWV */
        {{1, 1, 225, 7, 1, 0, 0}, "truck"},     /* M35 */
        {{1, 1, 225, 6, 25, 0, 0}, "motorcycle"},
        {{1, 1, 225, 81, 1, 1, 0}, "car"},
        {{1, 1, 0, 82, 0, 0, 0}, "bus"},
        {{1, 2, 225, 1, 3, 0, 0}, "fighter"},         /* F-16 */
        {{1, 2, 225, 2, 4, 0, 0}, "attack_aircraft"}, /* */
        {{1, 2, 225, 3, 2, 0, 0}, "bomber"},
        {{1, 2, 225, 4, 1, 0, 0}, "transport_aircraft"}, /* C-130 */
        {{1, 2, 225, 20, 1, 0, 0}, "helicopter"},        /* AH-64 */
        {{1, 2, 225, 21, 2, 0, 0}, "helicopter"},        /* UH-60 */
        {{1, 2, 225, 23, 1, 0, 0}, "helicopter"},        /* CH-47 */
        {{1, 2, 225, 50, 4, 0, 0}, "uav"},
        {{1, 2, 225, 57, 0, 0, 0}, "airliner"},
        {{1, 3, 225, 1, 1, 0, 0}, "aircraft_carrier"},
        {{1, 3, 225, 4, 1, 0, 0}, "warship"},
        {{1, 3, 0, 61, 3, 0, 0}, "cargo_ship"},
        {{1, 3, 0, 61, 9, 0, 0}, "boat"},
        {{1, 4, 225, 3, 1, 0, 0}, "submarine"},
        {{2, 1, 225, 1, 1, 0, 0}, "missile"},
        {{2, 2, 225, 1, 1, 3, 0}, "missile"}, /* TOW */
        {{2, 7, 225, 1, 1, 0, 0}, "torpedo"},
        {{2, 9, 225, 2, 73, 0, 0}, "bomb"}, /* Mk 82 */
        {{2, 2, 225, 2, 3, 0, 0}, "shell"},
        {{2, 8, 225, 3, 0, 0, 0}, "mine"},
        {{3, 1, 225, 1, 0, 0, 0}, "person"},
        {{3, 1, 0, 200, 0, 0, 0}, "animal"},
        {{5, 1, 225, 5, 0, 0, 0}, "bridge"},
        {{5, 1, 225, 1, 0, 0, 0}, "building"},
        {{0, 0, 0, 0, 0, 0, 0}, "other"},
        {{1, 1, 225, 0, 0, 0, 0}, "other"},
        {{255, 255, 65535, 255, 255, 255, 255}, "other"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        assert_string_equal(target_class_name(target_class(known[i].type)), known[i].class);
    /* of any type there is a class */
    for (int kind = 0; kind < 256; kind++)
        for (int domain = 0; domain < 8; domain++)
            for (int category = 0; category < 256; category++) {
                const int class =
                    target_class((DisEntityType){(uint8_t)kind, (uint8_t)domain, 225, (uint8_t)category, 3, 0, 0});
                CHECK(class >= 1 && class <= target_class_count());
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_keep_their_names),
        cmocka_unit_test(types_have_the_class_of_their_category),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
