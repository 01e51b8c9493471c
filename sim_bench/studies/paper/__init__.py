"""The paper's comparison, recomputed: data, competing methods, statistics, tables."""
