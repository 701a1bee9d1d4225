package armcmc.spy;

import java.lang.reflect.InvocationTargetException;
import java.lang.reflect.Method;
import java.lang.reflect.Modifier;

/** What tests assert, and what runs them: every public method without arguments of the classes that are named. */
public final class Check {
  private Check() {}

  public static void that(boolean condition, String what) {
    if (!condition) throw new AssertionError(what);
  }

  public static void equal(Object expected, Object actual) {
    that(expected == null ? actual == null : expected.equals(actual), "expected <" + expected + ">, got <" + actual + ">");
  }

  public static void near(double expected, double actual, double tolerance) {
    that(Math.abs(expected - actual) <= tolerance, "expected " + expected + " +- " + tolerance + ", got " + actual);
  }

  public static void main(String[] names) throws ReflectiveOperationException {
    int run = 0;
    int failed = 0;
    for (String name : names) {
      Class<?> test = Class.forName(name);
      for (Method method : test.getDeclaredMethods()) {
        if (!Modifier.isPublic(method.getModifiers()) || method.getParameterCount() > 0) continue;
        ++run;
        try {
          method.invoke(test.getDeclaredConstructor().newInstance());
        } catch (InvocationTargetException failure) {
          ++failed;
          System.err.println("FAILED " + name + "." + method.getName());
          failure.getCause().printStackTrace();
        }
      }
    }
    System.out.println(run + " tests, " + failed + " failed");
    System.exit(failed > 0 || run == 0 ? 1 : 0);
  }
}
