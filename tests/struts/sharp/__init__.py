"""Tests of sharp nodes."""
