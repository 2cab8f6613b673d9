/* Invalid calls, each of which must return a status and a message, and leave its outputs unchanged.
 *
 *     hostile CUBE
 */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <upglow.h>

static int failures = 0;

static void expect(int holds, const char *what) {
    if (!holds) {
        printf("FAILED: %s; the last message is: %s\n", what, upglow_message());
        failures++;
    }
}

#define REFUSED(call, status) expect((call) == (status), #call " gives " #status)
#define ACCEPTED(call) REFUSED(call, UPGLOW_STATUS_OK)
#define HOLDS(condition) expect((condition) ? 1 : 0, #condition)

/* The whole content of a file; NULL if it cannot be read. */
static uint8_t *content(const char *path, size_t *length) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return NULL;
    }
    fseek(file, 0, SEEK_END);
    *length = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*length);
    if (bytes != NULL && fread(bytes, 1, *length, file) != *length) {
        free(bytes);
        bytes = NULL;
    }
    fclose(file);
    return bytes;
}

static void null_pointers(const UpglowCube *cube, const UpglowMaterial *material) {
    static const float rgb[3] = {0.5f, 0.5f, 0.5f};
    static const float nm[8] = {400, 450, 500, 550, 600, 650, 700, 750};
    const UpglowStatus null = UPGLOW_STATUS_NULL_POINTER;
    UpglowCube *other = NULL;
    UpglowMaterial room;
    float value = 7, values[8] = {7};
    UpglowSample sample;

    REFUSED(upglow_cube_open(NULL, &other), null);
    REFUSED(upglow_cube_open("nowhere", NULL), null);
    REFUSED(upglow_cube_from_memory(NULL, 10, &other), null);
    REFUSED(upglow_cube_from_memory((const uint8_t *)"abc", 3, NULL), null);
    HOLDS(other == NULL);
    REFUSED(upglow_cube_facts(NULL, NULL), null);
    REFUSED(upglow_cube_facts(cube, NULL), null);
    REFUSED(upglow_look_up(NULL, rgb, &room), null);
    REFUSED(upglow_look_up(cube, NULL, &room), null);
    REFUSED(upglow_look_up(cube, rgb, NULL), null);
    HOLDS(strcmp(upglow_message(), "material is null, expected a pointer") == 0);
    REFUSED(upglow_look_up_many(NULL, rgb, &room, 1, NULL), null);
    REFUSED(upglow_look_up_many(cube, NULL, &room, 1, NULL), null);
    REFUSED(upglow_look_up_many(cube, rgb, NULL, 1, NULL), null);
    REFUSED(upglow_is_fluorescent(material, NULL), null);
    REFUSED(upglow_reflectance(NULL, 500, &value), null);
    REFUSED(upglow_reflectance(material, 500, NULL), null);
    REFUSED(upglow_reflectance_4(NULL, nm, values), null);
    REFUSED(upglow_reflectance_4(material, NULL, values), null);
    REFUSED(upglow_reflectance_4(material, nm, NULL), null);
    REFUSED(upglow_reflectance_8(NULL, nm, values), null);
    REFUSED(upglow_reflectance_8(material, NULL, values), null);
    REFUSED(upglow_reflectance_8(material, nm, NULL), null);
    REFUSED(upglow_reradiation(NULL, 400, 500, &value), null);
    REFUSED(upglow_reradiation(material, 400, 500, NULL), null);
    REFUSED(upglow_albedo(NULL, 400, &value), null);
    REFUSED(upglow_albedo(material, 400, NULL), null);
    REFUSED(upglow_sample_incident(NULL, 500, rgb, &sample), null);
    REFUSED(upglow_sample_incident(material, 500, NULL, &sample), null);
    REFUSED(upglow_sample_incident(material, 500, rgb, NULL), null);
    REFUSED(upglow_sample_outgoing(NULL, 500, rgb, &sample), null);
    REFUSED(upglow_sample_outgoing(material, 500, NULL, &sample), null);
    REFUSED(upglow_sample_outgoing(material, 500, rgb, NULL), null);
    REFUSED(upglow_incident_pdf(NULL, 400, 500, &value), null);
    REFUSED(upglow_incident_pdf(material, 400, 500, NULL), null);
    REFUSED(upglow_outgoing_pdf(NULL, 400, 500, &value), null);
    REFUSED(upglow_outgoing_pdf(material, 400, 500, NULL), null);
    REFUSED(upglow_incident_elastic_probability(NULL, 500, &value), null);
    REFUSED(upglow_incident_elastic_probability(material, 500, NULL), null);
    REFUSED(upglow_outgoing_elastic_probability(NULL, 500, &value), null);
    REFUSED(upglow_outgoing_elastic_probability(material, 500, NULL), null);
    HOLDS(value == 7 && values[0] == 7);
    upglow_cube_destroy(NULL);
    upglow_colors_destroy(NULL);
}

static void damaged_files(const char *path) {
    size_t length = 0;
    uint8_t *bytes = content(path, &length);
    HOLDS(bytes != NULL);
    UpglowCube *cube = NULL;
    const UpglowStatus refused = UPGLOW_STATUS_NOT_A_CUBE;

    REFUSED(upglow_cube_open("/nowhere/at/all", &cube), UPGLOW_STATUS_FILE);
    HOLDS(strstr(upglow_message(), "/nowhere/at/all: ") == upglow_message());
    REFUSED(upglow_cube_open("/", &cube), UPGLOW_STATUS_FILE);
    REFUSED(upglow_cube_from_memory(NULL, 0, &cube), refused);
    REFUSED(upglow_cube_from_memory((const uint8_t *)"SPEC\0\0\0\0", 8, &cube), refused);
    REFUSED(upglow_cube_from_memory(bytes, SIZE_MAX, &cube), UPGLOW_STATUS_INVALID_ARGUMENT);
    for (size_t cut = 0; bytes != NULL && cut < length; cut += length / 97 + 1) {
        /* A copy of that size, so that valgrind finds reads past its end. */
        uint8_t *part = malloc(cut + 1);
        memcpy(part, bytes, cut);
        REFUSED(upglow_cube_from_memory(part, cut, &cube), refused);
        free(part);
    }
    for (size_t at = 0; bytes != NULL && at < length; at += length / 97 + 1) {
        bytes[at] ^= 0x55;
        REFUSED(upglow_cube_from_memory(bytes, length, &cube), refused);
        bytes[at] ^= 0x55;
    }
    HOLDS(cube == NULL);
    ACCEPTED(upglow_cube_from_memory(bytes, length, &cube));
    free(bytes);
    upglow_cube_destroy(cube);
}

static void odd_numbers(const UpglowCube *cube, const UpglowMaterial *material) {
    static const float odd[6] = {NAN, INFINITY, -INFINITY, -1e-9f, 1.00001f, 3e38f};
    UpglowMaterial room, before;
    memset(&room, 0x11, sizeof room);
    memcpy(&before, &room, sizeof room);
    for (int i = 0; i < 6; i++) {
        for (int channel = 0; channel < 3; channel++) {
            float rgb[3] = {0.5f, 0.5f, 0.5f};
            rgb[channel] = odd[i];
            REFUSED(upglow_look_up(cube, rgb, &room), UPGLOW_STATUS_OUTSIDE);
        }
    }
    HOLDS(strstr(upglow_message(), "expected 0 to 1, the range of the cube") != NULL);
    HOLDS(memcmp(&room, &before, sizeof room) == 0);
    for (int i = 0; i < 6; i++) {
        const float u[2] = {odd[i], odd[i]}, four[4] = {odd[i], odd[i], 500, 500};
        float value, values[4];
        UpglowSample sample;
        ACCEPTED(upglow_reflectance(material, odd[i], &value));
        ACCEPTED(upglow_reflectance_4(material, four, values));
        ACCEPTED(upglow_reradiation(material, odd[i], odd[i], &value));
        ACCEPTED(upglow_albedo(material, odd[i], &value));
        ACCEPTED(upglow_sample_incident(material, odd[i], u, &sample));
        ACCEPTED(upglow_sample_outgoing(material, 450, u, &sample));
        ACCEPTED(upglow_sample_incident(material, 520, u, &sample));
    }
}

static void odd_materials(const UpglowCube *cube) {
    static const float rgb[3] = {0.05f, 0.9f, 0.1f};
    UpglowMaterial empty;
    memset(&empty, 0, sizeof empty);
    float value = 7, copied = 8;
    REFUSED(upglow_reflectance(&empty, 500, &value), UPGLOW_STATUS_INVALID_ARGUMENT);
    HOLDS(value == 7);
    const UpglowMaterial *odd = (const UpglowMaterial *)((const char *)&empty + 8);
    REFUSED(upglow_reflectance(odd, 500, &value), UPGLOW_STATUS_INVALID_ARGUMENT);

    /* In memory of `malloc`, and copied. */
    UpglowMaterial *material = malloc(2 * sizeof *material);
    ACCEPTED(upglow_look_up(cube, rgb, &material[0]));
    material[1] = material[0];
    ACCEPTED(upglow_reflectance(&material[0], 500, &value));
    memset(&material[0], 0, sizeof *material);
    ACCEPTED(upglow_reflectance(&material[1], 500, &copied));
    HOLDS(value == copied);
    free(material);
}

static void arrays_of_colors(const UpglowCube *cube) {
    enum { COUNT = 37 };
    const UpglowStatus invalid = UPGLOW_STATUS_INVALID_ARGUMENT;
    float rgb[COUNT][3], xyz[COUNT][3];
    for (int i = 0; i < COUNT; i++) {
        rgb[i][0] = rgb[i][1] = rgb[i][2] = (float)i / COUNT;
        xyz[i][0] = 7;
    }
    rgb[5][1] = NAN;
    rgb[36][2] = -1;
    UpglowColors *colors = NULL;
    REFUSED(upglow_colors_create(cube, "D66", &colors), invalid);
    REFUSED(upglow_colors_create(cube, "\xff", &colors), invalid);
    REFUSED(upglow_colors_create(NULL, NULL, &colors), UPGLOW_STATUS_NULL_POINTER);
    REFUSED(upglow_colors_create(cube, NULL, NULL), UPGLOW_STATUS_NULL_POINTER);
    HOLDS(colors == NULL);
    ACCEPTED(upglow_colors_create(cube, "A", &colors));

    size_t outside = 7;
    REFUSED(upglow_xyz(NULL, rgb[0], xyz[0], COUNT, &outside), UPGLOW_STATUS_NULL_POINTER);
    REFUSED(upglow_xyz(colors, NULL, xyz[0], COUNT, NULL), UPGLOW_STATUS_NULL_POINTER);
    REFUSED(upglow_xyz(colors, rgb[0], NULL, COUNT, NULL), UPGLOW_STATUS_NULL_POINTER);
    REFUSED(upglow_xyz(colors, rgb[0], rgb[0], COUNT, NULL), invalid);
    REFUSED(upglow_xyz(colors, rgb[0], rgb[1], COUNT - 1, NULL), invalid);
    REFUSED(upglow_xyz(colors, rgb[0], xyz[0], SIZE_MAX / 2, NULL), invalid);
    HOLDS(outside == 7 && xyz[0][0] == 7);
    ACCEPTED(upglow_xyz(colors, NULL, NULL, 0, &outside));
    HOLDS(outside == 0);
    ACCEPTED(upglow_xyz(colors, rgb[0], xyz[0], COUNT, &outside));
    HOLDS(outside == 2 && isnan(xyz[5][0]) && isnan(xyz[36][2]));
    HOLDS(xyz[0][1] == 0 && xyz[35][1] > 0.9f && xyz[35][1] < 1);
    upglow_colors_destroy(colors);
}

static void matrices_of_colors(const UpglowCube *cube) {
    const UpglowStatus null = UPGLOW_STATUS_NULL_POINTER, invalid = UPGLOW_STATUS_INVALID_ARGUMENT;
    const float rgb[3] = {0.4f, 0.4f, 0.4f}, odd[3] = {0.4f, NAN, 0.4f};
    float matrix[4][4], light[4] = {7};
    UpglowMatrices *matrices = NULL;
    matrix[0][0] = 7;
    REFUSED(upglow_matrices_create(NULL, NULL, &matrices), null);
    REFUSED(upglow_matrices_create(cube, NULL, NULL), null);
    REFUSED(upglow_matrices_create(cube, "rgb", &matrices), invalid);
    REFUSED(upglow_matrices_create(cube, "\xff", &matrices), invalid);
    HOLDS(matrices == NULL);
    ACCEPTED(upglow_matrices_create(cube, "rec709", &matrices));
    ACCEPTED(upglow_reduced_light(matrices, NULL, light));
    for (int i = 0; i < 4; i++) {
        HOLDS(fabsf(light[i] - 1) < 1e-6f);
    }
    upglow_matrices_destroy(matrices);
    light[0] = 7;
    ACCEPTED(upglow_matrices_create(cube, NULL, &matrices));
    REFUSED(upglow_reduced_matrix(NULL, rgb, matrix[0]), null);
    REFUSED(upglow_reduced_matrix(matrices, NULL, matrix[0]), null);
    REFUSED(upglow_reduced_matrix(matrices, rgb, NULL), null);
    REFUSED(upglow_reduced_matrix(matrices, odd, matrix[0]), UPGLOW_STATUS_OUTSIDE);
    REFUSED(upglow_reduced_light(NULL, NULL, light), null);
    REFUSED(upglow_reduced_light(matrices, NULL, NULL), null);
    REFUSED(upglow_reduced_light(matrices, "D66", light), invalid);
    REFUSED(upglow_reduced_light(matrices, "\xff", light), invalid);
    HOLDS(matrix[0][0] == 7 && light[0] == 7);
    ACCEPTED(upglow_reduced_matrix(matrices, rgb, matrix[0]));
    ACCEPTED(upglow_reduced_light(matrices, NULL, light));
    float y = 0;
    for (int i = 0; i < 4; i++) {
        y += matrix[1][i] * light[i];
    }
    /* Gray under the cube's own light. */
    HOLDS(fabsf(y - 0.4f) < 1e-3f && fabsf(light[1] - 1) < 1e-6f);
    upglow_matrices_destroy(matrices);
    upglow_matrices_destroy(NULL);
}

/* Many colors at once: the same as one at a time, and empty materials for colors outside. */
static void many_materials(const UpglowCube *cube) {
    enum { COUNT = 37 };
    const UpglowStatus invalid = UPGLOW_STATUS_INVALID_ARGUMENT;
    float rgb[COUNT][3];
    for (int i = 0; i < COUNT; i++) {
        rgb[i][0] = (float)i / COUNT;
        rgb[i][1] = 0.5f;
        rgb[i][2] = 1 - rgb[i][0];
    }
    rgb[5][1] = NAN;
    rgb[36][2] = -1;
    UpglowMaterial *many = malloc(COUNT * sizeof *many), one;
    memset(many, 0x11, COUNT * sizeof *many);
    one = many[0];
    size_t outside = 7;
    REFUSED(upglow_look_up_many(cube, rgb[0], many, SIZE_MAX / 2, &outside), invalid);
    REFUSED(upglow_look_up_many(cube, (const float *)many + 3, many, COUNT, &outside), invalid);
    HOLDS(strcmp(upglow_message(), "materials overlaps rgb, expected separate memory") == 0);
    HOLDS(outside == 7 && memcmp(&one, many, sizeof one) == 0);
    ACCEPTED(upglow_look_up_many(cube, NULL, NULL, 0, &outside));
    HOLDS(outside == 0);
    ACCEPTED(upglow_look_up_many(cube, rgb[0], many, COUNT, NULL));
    ACCEPTED(upglow_look_up_many(cube, rgb[0], many, COUNT, &outside));
    HOLDS(outside == 2);
    for (int i = 0; i < COUNT; i++) {
        float together = 7, alone = 8;
        if (i == 5 || i == 36) {
            REFUSED(upglow_reflectance(&many[i], 550, &together), invalid);
            continue;
        }
        ACCEPTED(upglow_look_up(cube, rgb[i], &one));
        ACCEPTED(upglow_reflectance(&one, 550, &alone));
        ACCEPTED(upglow_reflectance(&many[i], 550, &together));
        HOLDS(together == alone);
    }
    free(many);
}

/* Measured lights: invalid ones are refused, and white has Y = 1 under the others. */
static void sampled_lights(const UpglowCube *cube) {
    enum { COUNT = 54 };
    const UpglowStatus invalid = UPGLOW_STATUS_INVALID_ARGUMENT, null = UPGLOW_STATUS_NULL_POINTER;
    static const float rgb[2][3] = {{1, 1, 1}, {0.05f, 0.9f, 0.1f}};
    float nm[COUNT], flat[COUNT], odd[COUNT], flat_xyz[2][3], e_xyz[2][3];
    for (int i = 0; i < COUNT; i++) {
        nm[i] = 300.0f + 10.0f * (float)i;
        flat[i] = odd[i] = 5.0f;
    }
    UpglowColors *colors = NULL;
    REFUSED(upglow_colors_create_sampled(NULL, nm, flat, COUNT, &colors), null);
    REFUSED(upglow_colors_create_sampled(cube, NULL, flat, COUNT, &colors), null);
    REFUSED(upglow_colors_create_sampled(cube, nm, NULL, COUNT, &colors), null);
    REFUSED(upglow_colors_create_sampled(cube, nm, flat, COUNT, NULL), null);
    REFUSED(upglow_colors_create_sampled(cube, nm, flat, 0, &colors), invalid);
    REFUSED(upglow_colors_create_sampled(cube, nm, flat, COUNT - 1, &colors), invalid);
    REFUSED(upglow_colors_create_sampled(cube, flat, flat, COUNT, &colors), invalid);
    odd[7] = -0.5f;
    REFUSED(upglow_colors_create_sampled(cube, nm, odd, COUNT, &colors), invalid);
    HOLDS(strcmp(upglow_message(),
                 "sample 7: -0.5 in column \"power\", expected a value of 0 or more") == 0);
    odd[7] = NAN;
    REFUSED(upglow_colors_create_sampled(cube, nm, odd, COUNT, &colors), invalid);
    memset(odd, 0, sizeof odd);
    REFUSED(upglow_colors_create_sampled(cube, nm, odd, COUNT, &colors), invalid);
    HOLDS(colors == NULL);

    ACCEPTED(upglow_colors_create_sampled(cube, nm, flat, COUNT, &colors));
    ACCEPTED(upglow_xyz(colors, rgb[0], flat_xyz[0], 2, NULL));
    upglow_colors_destroy(colors);
    ACCEPTED(upglow_colors_create(cube, "E", &colors));
    ACCEPTED(upglow_xyz(colors, rgb[0], e_xyz[0], 2, NULL));
    upglow_colors_destroy(colors);
    for (int i = 0; i < 6; i++) {
        HOLDS(fabsf(flat_xyz[i / 3][i % 3] - e_xyz[i / 3][i % 3]) < 1e-6f);
    }
    HOLDS(fabsf(flat_xyz[0][1] - 1.0f) < 1e-5f);
}

/* Threads that share a cube and a material, each with a failure of its own. */
#define THREADS 8
#define ROUNDS 400

typedef struct Work {
    const UpglowCube *cube;
    const UpglowMaterial *material;
    float red;
    float sum;
    int failures;
} Work;

static void *work(void *argument) {
    Work *mine = argument;
    char expected[64];
    snprintf(expected, sizeof expected, "red is %g, expected 0 to 1, the range of the cube",
             (double)mine->red);
    for (int i = 0; i < ROUNDS; i++) {
        const float inside[3] = {(float)i / ROUNDS, 0.5f, 0.25f}, outside[3] = {mine->red, 0, 0};
        UpglowMaterial material;
        float one = 0, two = 0;
        mine->failures += upglow_look_up(mine->cube, outside, &material) != UPGLOW_STATUS_OUTSIDE;
        mine->failures += upglow_look_up(mine->cube, inside, &material) != UPGLOW_STATUS_OK;
        mine->failures += upglow_reflectance(&material, 550, &one) != UPGLOW_STATUS_OK;
        mine->failures += upglow_reflectance(mine->material, 550, &two) != UPGLOW_STATUS_OK;
        mine->failures += strcmp(upglow_message(), expected) != 0;
        mine->sum += one + two;
    }
    return NULL;
}

static void threads(const UpglowCube *cube, const UpglowMaterial *material) {
    pthread_t thread[THREADS];
    Work shares[THREADS];
    int started = 0;
    for (int i = 0; i < THREADS; i++) {
        shares[i] = (Work){cube, material, (float)(2 + i), 0, 0};
        started += pthread_create(&thread[i], NULL, work, &shares[i]) == 0;
    }
    HOLDS(started == THREADS);
    for (int i = 0; i < started; i++) {
        pthread_join(thread[i], NULL);
        HOLDS(shares[i].failures == 0);
        HOLDS(shares[i].sum == shares[0].sum);
    }
}

#ifdef __linux__
/* A symbol of every static library in Rust: a program may link another one. */
void rust_eh_personality(void) {}
#endif

int main(int count, char **arguments) {
    static const float rgb[3] = {0.05f, 0.9f, 0.1f};
    UpglowCube *cube = NULL;
    UpglowMaterial material;
    if (count != 2) {
        fprintf(stderr, "usage: hostile CUBE\n");
        return 2;
    }
    HOLDS(strcmp(upglow_message(), "") == 0);
    HOLDS(strcmp(upglow_status_name(UPGLOW_STATUS_OUTSIDE), "UPGLOW_STATUS_OUTSIDE") == 0);
    HOLDS(strcmp(upglow_status_name(-1), "unknown status") == 0);
    char version[32];
    snprintf(version, sizeof version, "%d.%d.%d", UPGLOW_VERSION_MAJOR, UPGLOW_VERSION_MINOR,
             UPGLOW_VERSION_PATCH);
    HOLDS(strcmp(upglow_version(), version) == 0);
    if (upglow_cube_open(arguments[1], &cube) != UPGLOW_STATUS_OK) {
        fprintf(stderr, "hostile: %s\n", upglow_message());
        return EXIT_FAILURE;
    }
    ACCEPTED(upglow_look_up(cube, rgb, &material));
    null_pointers(cube, &material);
    damaged_files(arguments[1]);
    odd_numbers(cube, &material);
    odd_materials(cube);
    arrays_of_colors(cube);
    matrices_of_colors(cube);
    many_materials(cube);
    sampled_lights(cube);
    threads(cube, &material);
    upglow_cube_destroy(cube);
    printf("failures %d\n", failures);
    return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
