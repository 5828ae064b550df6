"""The reference side: what path tracing in Mitsuba 3 says a case looks like."""
