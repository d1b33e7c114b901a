"""Mitsuba 3 twins of lte's metallic surfaces, for validate_against_mitsuba.py.

Mitsuba's `roughconductor` has the same GGX distribution, but Smith's masking of both directions as
if they were independent (G1 G1), and no Schlick. `lte_conductor` is that plugin times two closed
factors: height-correlated over independent masking (Heitz 2014), and Schlick's Fresnel. Everything
else stays Mitsuba's own: the distribution, sampling of visible normals, densities, multiple
importance sampling, integrator.
"""

MIN_ALPHA = 1e-3  # lte/pathtrace/materials/ggx.h


def register_conductor(mi):
    import drjit as dr

    class Conductor(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.alpha = props.get("alpha", 0.1)
            self.f0 = mi.Color3f([props.get(f"f0_{c}", 1.0) for c in "rgb"])
            self.nested = mi.load_dict({
                "type": "roughconductor", "distribution": "ggx", "material": "none",
                "alpha": self.alpha
            })
            self.m_flags = self.nested.flags()
            self.m_components = [self.nested.flags()]

        def smith_lambda(self, v):
            return 0.5 * (dr.sqrt(1 + dr.sqr(self.alpha) * mi.Frame3f.tan_theta_2(v)) - 1)

        def factor(self, wi, wo):
            a, b = self.smith_lambda(wi), self.smith_lambda(wo)
            x = 1 - dr.clamp(dr.dot(dr.normalize(wi + wo), wi), 0, 1)
            masking = (1 + a) * (1 + b) / (1 + a + b)
            return dr.select(
                (wi.z > 0) & (wo.z > 0), masking, 0) * (self.f0 + (1 - self.f0) * x ** 5)

        def sample(self, ctx, si, sample1, sample2, active=True):
            bs, weight = self.nested.sample(ctx, si, sample1, sample2, active)
            return bs, weight * self.factor(si.wi, bs.wo)

        def eval(self, ctx, si, wo, active=True):
            return self.nested.eval(ctx, si, wo, active) * self.factor(si.wi, wo)

        def pdf(self, ctx, si, wo, active=True):
            return self.nested.pdf(ctx, si, wo, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def to_string(self):
            return f"Conductor[alpha={self.alpha}]"

    mi.register_bsdf("lte_conductor", Conductor)


def surface_bsdf(pbr, reflectance, plain):
    """The BSDF of a glTF material. `plain` takes roughconductor as it is, with the color as a mere
    factor."""
    diffuse = {"type": "diffuse", "reflectance": reflectance}
    metallic, roughness = pbr.get("metallicFactor", 1.0), pbr.get("roughnessFactor", 1.0)
    if metallic == 0:
        return diffuse
    if "metallicRoughnessTexture" in pbr or reflectance["type"] != "rgb":
        raise SystemExit("textured metal is not supported by this script")
    alpha = max(roughness ** 2, MIN_ALPHA)
    if plain:
        metal = {
            "type": "roughconductor", "distribution": "ggx", "material": "none", "alpha": alpha,
            "specular_reflectance": reflectance
        }
    else:
        metal = {
            "type": "lte_conductor", "alpha": alpha,
            **{f"f0_{c}": v for c, v in zip("rgb", reflectance["value"])}
        }
    if metallic == 1:
        return metal
    return {"type": "blendbsdf", "weight": metallic, "bsdf_0": diffuse, "bsdf_1": metal}
