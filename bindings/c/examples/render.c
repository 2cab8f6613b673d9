/* The material of one color, as a renderer evaluates it: reflectance at the wavelengths of a path,
 * and the color it has under the cube's light.
 *
 *     render CUBE R G B
 */
#include <stdio.h>
#include <stdlib.h>

#include <upglow.h>

/* Hero wavelength sampling: the hero and the others are equally spaced over the spectrum. */
#define WAVELENGTHS 8
static const float FIRST_NM = 360.0f;
static const float LAST_NM = 760.0f;

/* Ends the program with the reason of a failure. */
static void check(UpglowStatus status) {
    if (status != UPGLOW_STATUS_OK) {
        fprintf(stderr, "render: %s (%s)\n", upglow_message(), upglow_status_name(status));
        exit(EXIT_FAILURE);
    }
}

static void print_cube(const UpglowCube *cube) {
    UpglowCubeFacts facts;
    check(upglow_cube_facts(cube, &facts));
    printf("space %s\n", facts.rgb_space);
    printf("illuminant %s\n", facts.illuminant);
    printf("resolution %u\n", (unsigned)facts.resolution);
}

static void print_spectra(const UpglowMaterial *material) {
    float lambda_nm[WAVELENGTHS], reflectance[WAVELENGTHS], four[4];
    for (int i = 0; i < WAVELENGTHS; i++) {
        lambda_nm[i] = FIRST_NM + (LAST_NM - FIRST_NM) * (float)i / WAVELENGTHS;
    }
    check(upglow_reflectance_8(material, lambda_nm, reflectance));
    for (int i = 0; i < WAVELENGTHS; i++) {
        printf("reflectance %g %.9g\n", lambda_nm[i], reflectance[i]);
    }
    check(upglow_reflectance_4(material, lambda_nm, four));
    for (int i = 0; i < 4; i++) {
        float one, albedo;
        check(upglow_reflectance(material, lambda_nm[i], &one));
        check(upglow_albedo(material, lambda_nm[i], &albedo));
        printf("four %g %.9g\n", lambda_nm[i], four[i]);
        printf("one %g %.9g\n", lambda_nm[i], one);
        printf("albedo %g %.9g\n", lambda_nm[i], albedo);
    }
}

static void print_color(const UpglowCube *cube, const float rgb[3]) {
    UpglowColors *colors;
    check(upglow_colors_create(cube, NULL, &colors));
    float xyz[3];
    check(upglow_xyz(colors, rgb, xyz, 1, NULL));
    printf("xyz %.9g %.9g %.9g\n", xyz[0], xyz[1], xyz[2]);
    upglow_colors_destroy(colors);
}

int main(int count, char **arguments) {
    if (count != 5) {
        fprintf(stderr, "usage: render CUBE R G B\n");
        return 2;
    }
    const float rgb[3] = {
        strtof(arguments[2], NULL), strtof(arguments[3], NULL), strtof(arguments[4], NULL)};
    UpglowCube *cube;
    check(upglow_cube_open(arguments[1], &cube));
    UpglowMaterial material; /* on the stack: a look-up allocates nothing */
    check(upglow_look_up(cube, rgb, &material));

    print_cube(cube);
    print_spectra(&material);
    print_color(cube, rgb);
    upglow_cube_destroy(cube);
    return EXIT_SUCCESS;
}
