//! Elementary functions against reference values computed with 200 bits (mpmath 1.3). The arguments of each function
//! are the six of 8000 random arguments whose results are closest to the midpoint of two doubles, so an error above
//! 0.5005 units in the last place is detected.

use wellposed_models::common::elementary::{Elementary, cr_arg, cr_cis, cr_from_polar};

type UnaryReferences = (fn(f64) -> f64, &'static [(u64, u64)]);
type BinaryReferences = (fn(f64, f64) -> f64, &'static [(u64, u64, u64)]);

const UNARY_REFERENCES: &[UnaryReferences] = &[
    (
        f64::cr_sin,
        &[
            (0xbffb42ac3141af77, 0xbfefb7ac4d0c3f22),
            (0xbfa2562eb683f84a, 0xbfa2552dd6a7dff1),
            (0x3fb89a63c2f9389a, 0x3fb890b2d171414c),
            (0x3fdd4c195d032133, 0x3fdc48e298337554),
            (0x3f89dfe1a2107c5c, 0x3f89dfb485a1ea3b),
            (0x40a38320b15f048e, 0x3f62e4cd7e4323cf),
        ],
    ),
    (
        f64::cr_cos,
        &[
            (0x3ffb875172347db2, 0xbfc318601104e167),
            (0xbfac1900eb5e40b1, 0x3feff3aae04be360),
            (0xc081a4780172d2d2, 0x3fe32e0c43b28fe9),
            (0x40315a89c0365827, 0x3fb3285f724ba06b),
            (0x4066905bd91ac0ee, 0xbfc0a3bb6c9e8bb6),
            (0xbf9197f9940bf2b2, 0x3feffeca7894fbb9),
        ],
    ),
    (
        f64::cr_tan,
        &[
            (0x4049b762b11e5fcc, 0x4002bc0a58cf4e50),
            (0xbfccbde5deeb44dc, 0xbfcd3c1b68ab5cc5),
            (0xbfb68479e4a1a193, 0xbfb6936370fcf38f),
            (0x402b3bcd4484385b, 0x3ffbebbc6f79a297),
            (0xc068989af4ea29cc, 0x4001f1c0ca5bf42e),
            (0x40ac33205de702e5, 0xbfc04f7b5f98938b),
        ],
    ),
    (
        f64::cr_asin,
        &[
            (0xbfed5a6cb4fab072, 0xbff29457961b5209),
            (0x3fd56747733bd4d8, 0x3fd5d2ed1b8dd642),
            (0x3fbe41f737888f80, 0x3fbe541d7059faff),
            (0xbfdf488eba25c088, 0xbfe057ccd095e310),
            (0xbfed0eed2d9f4e96, 0xbff237f0fbed64c5),
            (0x3fbd672356701a50, 0x3fbd77c94bed253e),
        ],
    ),
    (
        f64::cr_acos,
        &[
            (0xbfe25acfb2f3f682, 0x40017410b1c3cee7),
            (0xbfcecda63b1b93b8, 0x3ffd05757d7ee5a2),
            (0xbfe9bf76617aa070, 0x40040bf3134c4b71),
            (0xbfe3904149b6db08, 0x4001d41e4ca37bd8),
            (0x3fcc533982520b08, 0x3ff590035af2c2bb),
            (0x3fe111b03aaa859e, 0x3ff021773e3dbfc4),
        ],
    ),
    (
        f64::cr_atan,
        &[
            (0x3fcd9f341fac28c4, 0x3fcd1c04f35a1c1d),
            (0xbfd2215f490edc15, 0xbfd1aade7656de2f),
            (0xc074d3f109a1cefd, 0xbff915b0ca1c07f6),
            (0x3fd503aa2a3c8b9b, 0x3fd44df321e4007d),
            (0xbf8616d0f3cb902c, 0xbf861698d23798b0),
            (0x40347695385f5378, 0x3ff859fa10113e2c),
        ],
    ),
    (
        f64::cr_sinh,
        &[
            (0x4032580513d61e28, 0x41861403309f2034),
            (0x4021af6f71d66cc8, 0x40ab0b4b8d60ba9b),
            (0x402614862f57acf4, 0x40de6e60dc4d758c),
            (0xc02d120afe0e52fa, 0xc12f56f5adf96067),
            (0xc01632bf955313e8, 0xc06011ec7fba8875),
            (0x3fdfca14a37f3a00, 0x3fe08e6f739de88e),
        ],
    ),
    (
        f64::cr_cosh,
        &[
            (0xc02b0c460444e8a2, 0x4116ccd1f0dc4f13),
            (0xc001ef7106a134e0, 0x4013090184acc765),
            (0xc00f82a8a927f110, 0x4039b02b30f2016a),
            (0xc0291eac7877167c, 0x410163a251dfa852),
            (0x40001f83bd7a5198, 0x400e8c3150063b12),
            (0xc03135ee3242783a, 0x416c7019370aabac),
        ],
    ),
    (
        f64::cr_exp,
        &[
            (0x4078258b83869620, 0x62c4d348f51b6001),
            (0xc08023f6517df3d4, 0x115cefcf941a3452),
            (0x406bd9af086f2ec8, 0x5405a62608d25c9c),
            (0xc06a64631bdc9e14, 0x2ce5049d7bf91fc9),
            (0xc062c02f13da1a04, 0x32680a9d958ba2bc),
            (0xc06399db7dfd0468, 0x31cb5b45829cb98f),
        ],
    ),
    (
        f64::cr_exp2,
        &[
            (0xc05417bf556b1f28, 0x3ae8be3370ec063a),
            (0xc084708964f1751c, 0x170e8bc88e14a64b),
            (0xc071e7519dd8cc7e, 0x2e074e1b53922504),
            (0xc076de6cbb4f3290, 0x2911214868268837),
            (0xc088ef236ce21b0a, 0x0e113d7c14ad91aa),
            (0x406446476e2a4830, 0x4a1254c15c3e0d4b),
        ],
    ),
    (
        f64::cr_ln,
        &[
            (0x3f4a34b0190a1647, 0xc01c86603c94d7cb),
            (0x4027a2bd3bb75589, 0x4003c1c376c37e98),
            (0x4060e75c6cc3f3d6, 0x4013a0bea65e8682),
            (0x3ff1a1936b82b98d, 0x3fb8da286ac7db73),
            (0x3fab5b626168a2da, 0xc0076f50c6b298c4),
            (0x4009704f96028791, 0x3ff28260ddd403e4),
        ],
    ),
    (
        f64::cr_log2,
        &[
            (0x3fd58350ac0a36fc, 0xbff92a761ec09f0f),
            (0x3ff50649163de25c, 0x3fd93759363ded9e),
            (0x3ffa2a363c92fd74, 0x3fe6b4b7c9c89aa0),
            (0x3fd00bd65f175ea6, 0xbfffeef26742bdc1),
            (0x400294f285e6d70a, 0x3ff3740008741988),
            (0x3ffa40f98e41b36d, 0x3fe6dcd047f6b3c1),
        ],
    ),
    (
        f64::cr_log10,
        &[
            (0x3f9110317dd8215a, 0xbffc73a9c3720dd7),
            (0x3f83765a8e915c94, 0xc0002d554d9f4ad0),
            (0x40779d797dfa9609, 0x40049e54ec786a05),
            (0x40758a72525a3ae3, 0x40044c8ee8747dbc),
            (0x3f7574edf8bc1038, 0xc0023f11e95702b8),
            (0x400077b3a1fd8924, 0x3fd41109bd38794e),
        ],
    ),
];

const BINARY_REFERENCES: &[BinaryReferences] = &[
    (
        f64::cr_atan2,
        &[
            (0xbf797255b44c3546, 0xbf85c7c188512986, 0xc004e7369b637edb),
            (0x4000f4093b160a52, 0xbf98a5348e101a8c, 0x3ff9507fb4e7a239),
            (0x400f1463efcd97ad, 0xc041e2195245d362, 0x400844656969cde4),
            (0xc04223a3071071f8, 0x40377a05ac47f5e6, 0xbfefe2e113f77216),
            (0xbf786f8acbb20514, 0x3f54de818320e1a3, 0xbff5c460d38b78f0),
            (0xbf63f94bdd7e81fc, 0x3fa5ef8ba8049332, 0xbfad1b471bbbf728),
        ],
    ),
    (
        f64::cr_powf,
        &[
            (0x3f877d24d8638025, 0x3ff42cc2df2eb8f8, 0x3f6d4829aecff1e3),
            (0x4034d43dab91f421, 0x3ffcd31431dc1cb0, 0x406daf5c43823a31),
            (0x4093208fc118f6bb, 0x4013183b3b99fc52, 0x42ff41caa43b4729),
            (0x3f84b43eec46dbe7, 0xbffa4fa198e3f8c0, 0x409dd95c1e19fc1b),
            (0x4085e6b8b33b4c62, 0x40198a6ebd479f0c, 0x43b4849467131961),
            (0x3f3c8844f71e0ba0, 0xbfd7c8996b9748e0, 0x4031be966240faa8),
        ],
    ),
];

/// Every correctly rounded function returns the double nearest to the exact result.
#[test]
fn results_are_correctly_rounded() {
    for (index, (function, values)) in UNARY_REFERENCES.iter().enumerate() {
        for &(x, y) in *values {
            let (x, y) = (f64::from_bits(x), f64::from_bits(y));
            assert_eq!(
                function(x).to_bits(),
                y.to_bits(),
                "function {index} of {x:e}: {:e}, {y:e}",
                function(x)
            );
        }
    }
    for (index, (function, values)) in BINARY_REFERENCES.iter().enumerate() {
        for &(x, y, z) in *values {
            let [x, y, z] = [x, y, z].map(f64::from_bits);
            assert_eq!(function(x, y).to_bits(), z.to_bits(), "function {index} of {x:e}, {y:e}");
        }
    }
}

/// `root_sum_square`, √(x² + y²), is exact for Pythagorean triples at all scales, and otherwise differs from the
/// platform's `hypot` by at most the machine epsilon relative to the result.
#[test]
fn root_sum_square_is_accurate_at_all_scales() {
    for exponent in [-1070, -700, -466, -465, -1, 0, 40, 464, 466, 1000, 1018] {
        let scale = |x: f64| {
            let half = exponent / 2;
            x * 2f64.powi(half) * 2f64.powi(exponent - half)
        };
        for (x, y, z) in [(3.0, 4.0, 5.0), (-12.0, 5.0, 13.0), (0.0, -7.0, 7.0), (20.0, 21.0, 29.0)]
        {
            assert_eq!(scale(x).root_sum_square(scale(y)), scale(z), "{x}, {y} times 2^{exponent}");
        }
    }
    for (x, y) in [(0.3, 0.7), (1e-3, 2.0), (5.0, 5.1)] {
        let (found, library) = (x.root_sum_square(y), f64::hypot(x, y));
        assert!((found - library).abs() <= f64::EPSILON * library, "{x}, {y}");
    }
    assert_eq!(0f64.root_sum_square(-0.0), 0.0);
    assert_eq!(f64::NAN.root_sum_square(f64::INFINITY), f64::INFINITY);
    assert!(f64::NAN.root_sum_square(1.0).is_nan());
}

/// The complex functions `cr_cis`, `cr_from_polar` and `cr_arg` agree with sine, cosine and the angle.
#[test]
fn complex_functions_agree_with_real_functions() {
    for angle in [-3.0, -0.7, 0.0, 1e-9, 0.3, 2.0, 40.0] {
        let (sin, cos) = angle.cr_sin_cos();
        assert_eq!((sin, cos), (angle.cr_sin(), angle.cr_cos()));
        assert_eq!([cr_cis(angle).re, cr_cis(angle).im], [cos, sin]);
        let z = cr_from_polar(2.0, angle);
        assert_eq!([z.re, z.im], [2.0 * cos, 2.0 * sin]);
        let turns = (cr_arg(z) - angle) / std::f64::consts::TAU;
        assert!((turns - turns.round()).abs() < 1e-15, "{angle}: {turns}");
    }
}

/// The hash of the results for 2 × 10⁵ arguments equals the value computed without fused multiply-add
/// (`qemu-x86_64 -cpu Nehalem`).
#[test]
fn results_do_not_depend_on_fused_multiply_add() {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut add = |x: f64| {
        hash = (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3);
        hash ^= hash >> 29;
    };
    for _ in 0..200_000 {
        let (x, y, u) = (40.0 * (random() - 0.5), 40.0 * (random() - 0.5), 2.0 * random() - 1.0);
        let results = [x.cr_sin(), x.cr_cos(), x.cr_tan(), u.cr_asin(), u.cr_acos(), x.cr_atan()];
        results.into_iter().for_each(&mut add);
        let results = [x.cr_sinh(), x.cr_cosh(), x.cr_exp(), x.cr_atan2(y), x.root_sum_square(y)];
        results.into_iter().for_each(&mut add);
        let size = x.abs();
        let results = [size.cr_ln(), size.cr_log2(), size.cr_log10(), size.cr_powf(y)];
        results.into_iter().for_each(&mut add);
    }
    assert_eq!(hash, 0x2932_4677_9191_c95e, "{hash:#018x}");
}
