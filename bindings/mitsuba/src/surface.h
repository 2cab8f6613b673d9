/// A diffuse surface with the reflectance of a cube's material.

#pragma once

#include <array>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include <mitsuba/core/fresolver.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/warp.h>
#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/texture.h>

#include "cube.h"
#include "reflectance_table.h"

namespace upglow_mitsuba {

using namespace mitsuba;

/// The message for a parameter that is not a color, or that Mitsuba has upsampled to a spectrum.
constexpr const char *NO_COLOR =
    "upglow: the parameter \"color\" is a spectrum or not a color, expected three numbers "
    "(<vector name=\"color\" value=\"0.9,0.05,0.8\"/>) or a texture of them "
    "(a bitmap with raw=true), linear in the cube's RGB space";

/// A BSDF like Mitsuba's `diffuse`, with the reflectance of a cube's material.
template <typename Float, typename Spectrum>
class Surface : public BSDF<Float, Spectrum> {
public:
    MI_IMPORT_BASE(BSDF, m_flags, m_components)
    MI_IMPORT_TYPES(Texture)

    /// Traced code cannot call the library; it reads tables made with it.
    static constexpr bool Traced = dr::is_jit_v<Float>;
    using Table = ReflectanceTable<Float, Spectrum>;

    explicit Surface(const Properties &props) : Base(props) {
        m_cube = Cube::load(file_resolver()->resolve(props.get<std::string>("cube")).string());
        if (props.type("color") == Properties::Type::Vector)
            set_color(ScalarColor3f(props.get<ScalarVector3f>("color")));
        else
            set_texture(texture_of(props));
        m_flags = uint32_t(BSDFFlags::DiffuseReflection) | uint32_t(BSDFFlags::FrontSide);
        if (m_texture)
            m_flags |= uint32_t(BSDFFlags::SpatiallyVarying);
        m_components.push_back(m_flags);
    }

    void traverse(TraversalCallback *callback) override {
        if (m_texture)
            callback->put("color", m_texture, ParamFlags::Differentiable);
        else
            callback->put("color", m_asked_color, ParamFlags::NonDifferentiable);
    }

    void parameters_changed(const std::vector<std::string> &) override {
        if (!m_texture)
            set_color(m_asked_color);
    }

    std::pair<BSDFSample3f, Spectrum> sample(const BSDFContext &context,
                                             const SurfaceInteraction3f &si, Float /*lobe*/,
                                             const Point2f &u, Mask active) const override {
        BSDFSample3f drawn      = dr::zeros<BSDFSample3f>();
        drawn.wo                = warp::square_to_cosine_hemisphere(u);
        drawn.pdf               = pdf(context, si, drawn.wo, active);
        drawn.eta               = 1.f;
        drawn.sampled_type      = uint32_t(BSDFFlags::DiffuseReflection);
        drawn.sampled_component = 0;
        return { drawn, reflectance(si, active && drawn.pdf > 0.f) };
    }

    Spectrum eval(const BSDFContext &context, const SurfaceInteraction3f &si, const Vector3f &wo,
                  Mask active) const override {
        return eval_pdf(context, si, wo, active).first;
    }

    /// The cosine of the outgoing direction over pi, on the front side.
    Float pdf(const BSDFContext &context, const SurfaceInteraction3f &si, const Vector3f &wo,
              Mask active) const override {
        if (!context.is_enabled(BSDFFlags::DiffuseReflection))
            return 0.f;
        active &= Frame3f::cos_theta(si.wi) > 0.f && Frame3f::cos_theta(wo) > 0.f;
        return dr::select(active, warp::square_to_cosine_hemisphere_pdf(wo), 0.f);
    }

    std::pair<Spectrum, Float> eval_pdf(const BSDFContext &context, const SurfaceInteraction3f &si,
                                        const Vector3f &wo, Mask active) const override {
        Float density = pdf(context, si, wo, active);
        return { reflectance(si, active && density > 0.f) * density, density };
    }

    Spectrum eval_diffuse_reflectance(const SurfaceInteraction3f &si, Mask active) const override {
        return reflectance(si, active);
    }

    std::string to_string() const override {
        std::ostringstream text;
        text << "UpglowSurface[" << std::endl
             << "  cube = \"" << m_cube->path() << "\"," << std::endl
             << "  rgb_space = \"" << m_cube->rgb_space() << "\"," << std::endl
             << "  color = ";
        if (m_texture)
            text << string::indent(m_texture->to_string());
        else
            text << m_color;
        text << std::endl << "]";
        return text.str();
    }

protected:
    /// The material at a point, looked up by the library; not for traced code.
    UpglowMaterial material_at(const SurfaceInteraction3f &si) const {
        if (!m_texture)
            return m_material;
        Color3f rgb = color_at(si, true);
        return m_cube->look_up({ rgb[0], rgb[1], rgb[2] });
    }

private:
    void set_color(ScalarColor3f color) {
        m_asked_color = m_color;  // Stays if the new color is refused.
        m_material    = m_cube->look_up({ color[0], color[1], color[2] });
        m_color = m_asked_color = color;
        if constexpr (Traced)
            set_table(std::make_shared<const Table>(Table::of_material(m_material)));
    }

    void set_texture(Texture *texture) {
        m_texture = texture;
        if constexpr (Traced)
            set_table(shared_node_table<Float, Spectrum>(m_cube));
    }

    void set_table(std::shared_ptr<const Table> table) {
        m_table = table;
        m_words = table->words();
    }

    static Texture *texture_of(const Properties &props) {
        Texture *texture = props.try_get<Texture>("color");
        // Textures without spatial variation are spectra, some of which `eval_3` has coefficients of.
        if (!texture || !texture->is_spatially_varying() || !has_colors(*texture))
            throw std::runtime_error(NO_COLOR);
        return texture;
    }

    /// Whether a texture has colors, which only shows when one is evaluated.
    static bool has_colors(const Texture &texture) {
        if (texture.class_name() == "MeshAttribute")
            return true;  // It cannot be evaluated without its mesh.
        try {
            texture.eval_3(dr::zeros<SurfaceInteraction3f>());
            return true;
        } catch (const std::exception &) {
            return false;
        }
    }

    /// The texture's color, clamped to the cube.
    Color3f color_at(const SurfaceInteraction3f &si, Mask active) const {
        Color3f rgb = m_texture->eval_3(si, active);
        // NaN compares false, and becomes 0.
        return dr::select(rgb > 0.f, dr::minimum(rgb, 1.f), 0.f);
    }

    Spectrum reflectance(const SurfaceInteraction3f &si, Mask active) const {
        if constexpr (!Traced)
            return active ? reflectances(material_at(si), si.wavelengths) : Spectrum(0.f);
        else if (m_texture)
            return m_table->at(color_at(si, active), si.wavelengths, active) & active;
        else
            return m_table->at(si.wavelengths, active) & active;
    }

    static Spectrum reflectances(const UpglowMaterial &material, const Wavelength &wavelengths) {
        std::array<float, 4> lambda_nm, reflectance;
        dr::store(lambda_nm.data(), wavelengths);
        expect_ok(upglow_reflectance_4(&material, lambda_nm.data(), reflectance.data()));
        return dr::load<Spectrum>(reflectance.data());
    }

    std::shared_ptr<const Cube> m_cube;
    ref<Texture> m_texture;
    ScalarColor3f m_color = 0.f;
    /// Python writes to this before it calls `parameters_changed`.
    ScalarColor3f m_asked_color = 0.f;
    UpglowMaterial m_material{};
    std::shared_ptr<const Table> m_table;
    /// A reference to the table's array, for Dr.Jit to find when it replays a traced function.
    typename Table::UInt32 m_words;

    MI_DECLARE_CLASS(UpglowSurface)
    MI_TRAVERSE_CB(Base, m_texture, m_words)
};

}  // namespace upglow_mitsuba
