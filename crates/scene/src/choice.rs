//! Words that a scene may choose from, each declared once.
//!
//! `choices!` makes of one declaration the enum, its words in scenes, its documentation for people, and its
//! serialisation; a word cannot be accepted without being documented.

/// One word and what it means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The word, as written in a scene.
    pub name: &'static str,
    /// What it means.
    pub about: &'static str,
}

/// An enum whose members are words of a scene.
pub trait Named: Copy + PartialEq + 'static {
    /// The members, in order.
    const ALL: &'static [Self];
    /// Their words, in the same order.
    const CHOICES: &'static [Choice];

    /// The member's word.
    fn name(self) -> &'static str {
        let index = Self::ALL.iter().position(|member| *member == self).expect("ALL lists every member");
        Self::CHOICES[index].name
    }

    /// The member with this word.
    fn by_name(name: &str) -> Option<Self> {
        Self::CHOICES.iter().position(|choice| choice.name == name).map(|index| Self::ALL[index])
    }
}

/// Declares an enum as a set of words: `Variant = "word"`, where the doc comment is the documentation of the word.
macro_rules! choices {
    ($(#[doc = $enum_about:literal])+ pub enum $enum:ident {
        $($(#[doc = $about:literal])+ $variant:ident = $name:literal,)+
    }) => {
        $(#[doc = $enum_about])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $enum {
            $($(#[doc = $about])+ $variant,)+
        }

        impl $crate::choice::Named for $enum {
            const ALL: &'static [Self] = &[$($enum::$variant),+];
            const CHOICES: &'static [$crate::choice::Choice] =
                &[$($crate::choice::Choice { name: $name, about: concat!($($about),+) }),+];
        }

        impl std::fmt::Display for $enum {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str($crate::choice::Named::name(*self))
            }
        }

        impl serde::Serialize for $enum {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str($crate::choice::Named::name(*self))
            }
        }
    };
}
pub(crate) use choices;

choices! {
    /// A coordinate axis.
    pub enum Axis {
        /// The first axis.
        X = "x",
        /// The second axis.
        Y = "y",
        /// The third axis.
        Z = "z",
    }
}

impl Axis {
    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }
}
