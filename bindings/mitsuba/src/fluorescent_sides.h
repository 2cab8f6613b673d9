/// Which sides of a BSDF fluoresce, including BSDFs inside Mitsuba's wrapper `twosided`.

#pragma once

#include <map>
#include <string>

#include <mitsuba/render/bsdf.h>

#include "fluorescence.h"

namespace upglow_mitsuba {

/// The objects inside a BSDF, by their paths in Python's `mitsuba.traverse`.
class Nested final : public mitsuba::TraversalCallback {
public:
    explicit Nested(mitsuba::Object *object) { object->traverse(this); }

    std::map<std::string, mitsuba::Object *> objects;

protected:
    void put_value(std::string_view, void *, uint32_t, const std::type_info &) override {}

    void put_object(std::string_view name, mitsuba::Object *object, uint32_t) override {
        std::string outer = m_prefix;
        if (object && objects.emplace(outer + std::string(name), object).second) {
            m_prefix = outer + std::string(name) + ".";
            object->traverse(this);
            m_prefix = outer;
        }
    }

private:
    std::string m_prefix;
};

/// The fluorescent surfaces on the two sides of a BSDF; null for a side that does not fluoresce.
template <typename Float, typename Spectrum> class FluorescentSides {
public:
    using Surface = Fluorescence<Float, Spectrum>;
    using BSDF    = mitsuba::BSDF<Float, Spectrum>;

    FluorescentSides() = default;

    explicit FluorescentSides(const BSDF *bsdf) {
        if ((m_front = dynamic_cast<const Surface *>(bsdf)))
            return;
        // Traversal does not change the BSDF, although it is not declared const.
        Nested nested(const_cast<BSDF *>(bsdf));
        if (bsdf->class_name() == "TwoSidedBRDF") {
            auto front = nested.objects.find("brdf_0"), back = nested.objects.find("brdf_1");
            auto end = nested.objects.end();
            m_front  = front == end ? nullptr : dynamic_cast<const Surface *>(front->second);
            m_back   = back == end ? m_front : dynamic_cast<const Surface *>(back->second);
        }
        for (auto &[path, object] : nested.objects) {
            const Surface *surface = dynamic_cast<const Surface *>(object);
            m_loses |= surface && surface != m_front && surface != m_back;
        }
    }

    /// The surface on the side of a direction with this cosine to the normal.
    const Surface *met_at(float cosine) const { return cosine > 0.f ? m_front : m_back; }

    /// Whether it contains a fluorescent surface that integrators cannot access.
    bool loses() const { return m_loses; }

private:
    const Surface *m_front = nullptr, *m_back = nullptr;
    bool m_loses = false;
};

}  // namespace upglow_mitsuba
