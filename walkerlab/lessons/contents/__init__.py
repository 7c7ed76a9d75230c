"""Exercises and quizzes, one module for each lesson: ``lesson_03.py`` with ``EXERCISES`` and ``QUIZ``."""
