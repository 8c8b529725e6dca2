//! The elastic rod: what a continuum model would have said, [P] section 3, eqs (30) and (31).
